// Page that takes a program, completes its job and shows its report: host/src/commands/view.
import { InPage, Server, text, type Backend } from './backend';

interface Question {
    key: string;
    line: number;
    column: number;
    help: string;
}

/** State as the server has it. */
interface State {
    program: string | null;
    job: string | null;
    is_fixed: boolean;
    questions: Question[];
    messages: string;
    has_failed: boolean;
    has_report: boolean;
}

function element<T extends HTMLElement>(id: string): T {
    return document.getElementById(id) as T;
}

let state: State | null = null;
let backend: Backend = new Server();
/** The form has values that are not in the job. */
let isFormChanged = false;

/** Shows the state; the report only if it is a new one. */
function show(next: State, isNewReport: boolean): void {
    state = next;
    element('state').textContent = '';
    element('program').textContent = next.program ?? '';
    const hasJob = next.job !== null;
    element('values-part').hidden = !hasJob || next.is_fixed;
    element('job-part').hidden = !hasJob;
    const job = element<HTMLTextAreaElement>('job');
    job.value = next.job ?? '';
    job.readOnly = next.is_fixed;
    element('questions').replaceChildren(...next.questions.map(field));
    element('messages').hidden = next.messages.trim() === '';
    element('messages').textContent = next.messages;
    element('stale').hidden = true;
    element('report-part').hidden = !next.has_report;
    if (!next.has_report) showReport(null);
    else if (isNewReport) void backend.address('report').then(({ url }) => state === next && showReport(url));
    document.documentElement.dataset.state = 'ready';
}

/** A new frame for every report: in one that is still empty after its last page, a browser under load may lose the next one. */
function showReport(url: string | null): void {
    const last = element<HTMLIFrameElement>('report');
    const next = last.cloneNode() as HTMLIFrameElement;
    if (url === null) next.removeAttribute('src');
    else next.src = url;
    last.replaceWith(next);
}

/** Field of an open question. */
function field({ key, help }: Question): HTMLElement {
    const [label, input, hint] = [document.createElement('label'), document.createElement('input'), document.createElement('span')];
    input.name = key;
    input.autocomplete = 'off';
    hint.className = 'hint';
    hint.textContent = help;
    label.append(`${key} `, input, hint);
    return label;
}

/** An answer as TOML: numbers, truth values, lists and tables as they are, all else as text. Its key may stand before it. */
function toToml(line: string): string {
    const answer = line.replace(/^[A-Za-z_.]+\s*=\s*/, '').replace(/^"(.*)"$/, '$1');
    const isValue = /^([+-]?\d[\d_]*(\.\d+)?([eE][+-]?\d+)?|true|false|\[.*\]|\{.*\})$/s.test(answer);
    return isValue ? answer : JSON.stringify(answer);
}

/** Text of the job with the answers in the places of its open questions. */
function answered(): string {
    const text = element<HTMLTextAreaElement>('job').value;
    // A text that was changed by hand has its own places.
    if (!state || text !== state.job) return text;
    const lines = text.split('\n');
    for (const { key, line, column } of [...state.questions].reverse()) {
        const input = element<HTMLFormElement>('questions').elements.namedItem(key) as HTMLInputElement | null;
        const answer = input?.value.trim();
        if (!answer) continue;
        const characters = [...lines[line - 1]];
        characters.splice(column - 1, 3, toToml(answer));
        lines[line - 1] = characters.join('');
    }
    return lines.join('\n');
}

/** Sends something, and shows the state that follows; returns whether arcfeed has done it. */
async function post(path: string, body: BodyInit, words: string): Promise<boolean> {
    const began = performance.now();
    const clock = () => (element('elapsed').textContent = `${((performance.now() - began) / 1000).toFixed(0)} s`);
    const timer = setInterval(clock, 500);
    element('state').textContent = words;
    document.documentElement.dataset.state = 'busy';
    busy(true);
    try {
        const answer = await backend.request(path, body);
        if (answer.isOk) {
            const next: State = JSON.parse(text(answer));
            show(next, true);
            if (next.has_failed) element('messages').scrollIntoView({ block: 'nearest' });
            return !next.has_failed;
        }
        failed(text(answer));
    } catch (error) {
        failed(error instanceof Error ? error.message : String(error));
    } finally {
        clearInterval(timer);
        element('elapsed').textContent = '';
        busy(false);
    }
    return false;
}

function busy(isBusy: boolean): void {
    element<HTMLButtonElement>('stop').disabled = !isBusy;
    for (const button of document.querySelectorAll<HTMLButtonElement>('#run, #values button')) button.disabled = isBusy;
}

function failed(words: string): void {
    element('state').textContent = words;
    document.documentElement.dataset.state = 'failed';
}

async function take(file: File | undefined): Promise<void> {
    if (!file) return;
    // The values are those of the program before.
    element<HTMLFormElement>('values').reset();
    isFormChanged = false;
    await post(`program?${encodeURIComponent(file.name).replace(/%../g, '_')}`, file, `Reading ${file.name} …`);
}

async function propose(): Promise<boolean> {
    const values = Object.fromEntries(new FormData(element<HTMLFormElement>('values')));
    const isDone = await post('init', JSON.stringify(values), 'Proposing the job …');
    isFormChanged &&= !isDone;
    return isDone;
}

const REPLACES = 'The job has been changed by hand. Replace it by a job with the values of the fields?';

function isJobChanged(): boolean {
    return state?.job != null && element<HTMLTextAreaElement>('job').value !== state.job;
}

/** Values of the form that are not in the job yet come first; what the job then asks for is open. */
async function run(): Promise<void> {
    if (isFormChanged && (!isJobChanged() || confirm(REPLACES))) {
        if (!(await propose()) || (state?.questions.length ?? 0) > 0) return;
    }
    if (await post('run', answered(), 'Adapting and simulating …')) element('report-part').scrollIntoView();
}

/** What is changed is not in the report yet. */
function changed(): void {
    element('stale').hidden = false;
}

function controls(): void {
    const drop = element('drop');
    drop.addEventListener('dragover', (event) => {
        event.preventDefault();
        drop.classList.add('over');
    });
    drop.addEventListener('dragleave', () => drop.classList.remove('over'));
    drop.addEventListener('drop', (event) => {
        event.preventDefault();
        drop.classList.remove('over');
        void take(event.dataTransfer?.files[0]);
    });
    // A file that misses the zone would be opened in place of the page.
    addEventListener('dragover', (event) => event.preventDefault());
    addEventListener('drop', (event) => event.preventDefault());
    const file = element<HTMLInputElement>('file');
    file.addEventListener('change', () => void take(file.files?.[0]));
    const values = element<HTMLFormElement>('values');
    values.addEventListener('submit', (event) => {
        event.preventDefault();
        if (!isJobChanged() || confirm(REPLACES)) void propose();
    });
    element('questions').addEventListener('submit', (event) => {
        event.preventDefault();
        element('run').click();
    });
    element('run').addEventListener('click', () => void run());
    values.addEventListener('input', () => (isFormChanged = true));
    for (const id of ['values', 'questions', 'job']) element(id).addEventListener('input', changed);
    element('stop').addEventListener('click', () => backend.stop());
}

/** The example that is in the page: a program and its job. */
function example(): void {
    const [program, job] = ['example-program', 'example-job'].map((id) => document.getElementById(id));
    const button = element<HTMLButtonElement>('example');
    button.hidden = !program || !job;
    button.addEventListener('click', async () => {
        await take(new File([program?.textContent ?? ''], program?.dataset.name ?? ''));
        element<HTMLTextAreaElement>('job').value = job?.textContent ?? '';
        element('run').click();
    });
}

/** Downloads come from arcfeed inside the page; a server has them at their addresses. */
function downloads(): void {
    for (const link of document.querySelectorAll<HTMLAnchorElement>('.downloads a')) {
        const path = link.getAttribute('href') ?? '';
        link.addEventListener('click', async (event) => {
            event.preventDefault();
            const { url, name } = await backend.address(path);
            const file = Object.assign(document.createElement('a'), { href: url });
            if (name && path !== 'report') file.download = name;
            else file.target = '_blank';
            file.click();
        });
    }
}

async function start(): Promise<void> {
    const isDark = matchMedia('(prefers-color-scheme: dark)').matches;
    document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
    controls();
    const arcfeed = document.getElementById('arcfeed-wasm')?.textContent;
    if (arcfeed) {
        element('where').textContent = 'arcfeed runs inside this page: nothing leaves it.';
        backend = await InPage.load(arcfeed);
        downloads();
        example();
    }
    show(JSON.parse(text(await backend.request('state'))), true);
}

void start();
