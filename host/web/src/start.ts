// Page that takes a program, completes its job and shows its report: host/src/commands/view.
import { InPage, Server, text, type Backend } from './backend';
import { Form, type Problem, type ProposedTool } from './form';
import { Questions, type Question } from './questions';
import { StockFields, type Extents } from './stockfields';

interface Group {
    tool: number | null;
    direction: string;
    radius: number;
    arcs: number;
    helices: number;
    n: [number, number] | null;
    line: [number, number];
}

/** What `arcfeed init` has found in the program. */
interface Found {
    unit: string | null;
    arcs: number;
    extents: Extents;
    spindle_speeds: number[];
    groups: Group[];
    proposed: ProposedTool[];
}

/** State as the server has it. */
interface State {
    program: string | null;
    job: string | null;
    is_fixed: boolean;
    questions: Question[];
    messages: string;
    has_report: boolean;
    found: Found | null;
    problems: Problem[];
}

/** Cause of a new state: another program, values of the form, a run. */
type Cause = 'program' | 'values' | 'run';

function element<T extends HTMLElement>(id: string): T {
    return document.getElementById(id) as T;
}

let state: State | null = null;
let backend: Backend = new Server();
const form = new Form(element('values'), changed);
const stock = new StockFields(element('stock-fields'), compose);
const questions = new Questions(element('questions'), compose);
/** The text of the job was changed by hand. */
let isEdited = false;
/** Values of the form in the job, and the job of the report. */
let [inJob, inReport] = ['', ''];
/** What the job's values were warned of. */
let warnings = '';
/** Field of the form with an open question. */
let asked = '';

/** Writes the job with answers and stock, unless it was changed by hand. */
function compose(): void {
    if (!isEdited) element<HTMLTextAreaElement>('job').value = stock.added(questions.answered());
    changed();
}

const jobText = () => element<HTMLTextAreaElement>('job').value;
const formText = () => JSON.stringify(form.values());

/** Marks results that belong to another job. */
function changed(): void {
    const isStale = state?.has_report === true && !state.is_fixed && (jobText() !== inReport || formText() !== inJob);
    element('stale').hidden = !isStale;
    element('report-part').classList.toggle('stale', isStale);
}

/** Shows the state that follows from a cause. */
function show(next: State, cause: Cause): void {
    const before = state;
    state = next;
    element('state').textContent = '';
    element('program').textContent = next.program ?? '';
    document.documentElement.dataset.state = 'ready';
    if (form.refuse(next.problems)) return;
    const hasJob = next.job !== null;
    element('values-part').hidden = !hasJob || next.is_fixed;
    element('job-part').hidden = !hasJob;
    if (cause === 'program') {
        questions.forget();
        stock.clear();
        stock.extents = next.found?.extents ?? [];
        element('stock-fields').hidden = next.is_fixed || stock.extents.some((extent) => !extent);
        form.begin(next.found?.proposed ?? [], next.found?.unit ?? '');
        showFound(next.found);
    }
    if (cause !== 'run') {
        inJob = formText();
        warnings = next.messages.split('\n').filter((line) => line.startsWith('warning: ')).map((line) => `${line}\n`).join('');
    }
    const messages = (cause === 'run' && !isEdited ? warnings : '') + next.messages;
    showJob(next, cause);
    element('messages').hidden = messages.trim() === '';
    element('messages').textContent = messages;
    element('report-part').hidden = !next.has_report;
    if (!next.has_report) showReport(null);
    else if (cause === 'run' || !before) void backend.address('report').then(({ url }) => state === next && showReport(url));
    if (cause === 'run') inReport = jobText();
    changed();
    if (cause === 'run') element(next.has_report ? 'report-part' : 'messages').scrollIntoView();
    else if (!hasJob && next.messages) element('messages').scrollIntoView({ block: 'nearest' });
}

/** After a run, the fields of the questions stay with their answers: an answer may have been wrong. */
function showJob(next: State, cause: Cause): void {
    const job = element<HTMLTextAreaElement>('job');
    job.readOnly = next.is_fixed;
    if (cause === 'run' && !isEdited) return;
    questions.take(next.job ?? '', next.questions);
    if (cause !== 'run') isEdited = false;
    job.value = stock.added(questions.answered());
    const mode = /^mode = "(.*)"/m.exec(next.job ?? '');
    const proposed = element<HTMLFormElement>('values').querySelector('[name=mode] option');
    if (proposed && mode && !form.values().mode) proposed.textContent = `as proposed (${mode[1]})`;
}

/** What the program has: tools, arcs by radius. */
function showFound(found: Found | null): void {
    const part = element('found');
    part.hidden = !found;
    if (!found) return;
    const unit = found.unit ?? '';
    const tools = found.proposed.map(({ number, kind, diameter, comment_line }) => {
        const name = number === null ? 'The tool' : `T${number}`;
        const size = diameter === null ? 'diameter not in the program' : `diameter ${diameter} ${unit}${comment_line === null ? '' : `, from line ${comment_line}`}`;
        return kind === 'cup-mill' ? `${name}: likely a cup mill` : `${name}: likely an end mill, ${size}`;
    });
    const arcs = (direction: string) => found.groups.filter((group) => group.direction === direction).reduce((sum, { arcs }) => sum + arcs, 0);
    const [words, details, title, list] = ['p', 'details', 'summary', 'ul'].map((tag) => document.createElement(tag));
    words.textContent = `${tools.join('; ')}. ${found.spindle_speeds.map((speed) => `S${speed}`).join(', ')}`;
    title.textContent = `${found.arcs} arcs: ${arcs('ccw')} ccw, ${arcs('cw')} cw`;
    list.replaceChildren(...found.groups.map(({ tool, direction, radius, arcs, helices, n, line }) => {
        const item = document.createElement('li');
        const [first, last] = n ?? line;
        const where = `${n ? 'N' : 'line '}${first}${last === first ? '' : ` to ${n ? 'N' : ''}${last}`}`;
        const helix = helices === 0 ? '' : helices === arcs ? ', helices, which keep their feed' : `, ${helices} of them helices, which keep their feed`;
        item.textContent = `${tool === null ? '' : `T${tool}: `}${arcs} ${direction} R${Number(radius.toFixed(4))} ${unit}, ${where}${helix}`;
        return item;
    }));
    details.append(title, list);
    part.replaceChildren(words, ...(found.arcs > 0 ? [details] : []));
}

/** A new frame for every report: in one that is still empty after its last page, a browser under load may lose the next one. */
function showReport(url: string | null): void {
    const last = element<HTMLIFrameElement>('report');
    const next = last.cloneNode() as HTMLIFrameElement;
    if (url === null) next.removeAttribute('src');
    else next.src = url;
    last.replaceWith(next);
}

/** Sends something, and shows the state that follows; whether arcfeed has accepted it. */
async function post(path: string, body: BodyInit, words: string, cause: Cause): Promise<boolean> {
    const began = performance.now();
    const clock = () => (element('elapsed').textContent = `${((performance.now() - began) / 1000).toFixed(0)} s`);
    const timer = setInterval(clock, 500);
    element('state').textContent = words;
    document.documentElement.dataset.state = 'busy';
    busy(true);
    try {
        const answer = await backend.request(path, body);
        if (answer.isOk) show(JSON.parse(text(answer)), cause);
        else failed(text(answer));
        return answer.isOk && state?.problems.length === 0;
    } catch (error) {
        failed(error instanceof Error ? error.message : String(error));
        return false;
    } finally {
        clearInterval(timer);
        element('elapsed').textContent = '';
        busy(false);
    }
}

function busy(isBusy: boolean): void {
    element<HTMLButtonElement>('stop').disabled = !isBusy;
    for (const button of document.querySelectorAll<HTMLButtonElement>('#run, #values button')) button.disabled = isBusy;
}

function failed(words: string): void {
    element('state').textContent = words;
    element('state').scrollIntoView({ block: 'nearest' });
    document.documentElement.dataset.state = 'failed';
}

/** Asks which of the two stays, if the job was changed by hand; empty: none of them yet. */
async function choose(): Promise<string> {
    if (!isEdited) return 'form';
    const dialog = element<HTMLDialogElement>('conflict');
    dialog.returnValue = '';
    dialog.showModal();
    await new Promise((done) => dialog.addEventListener('close', done, { once: true }));
    return dialog.returnValue;
}

/** Puts the values of the form into the job; whether the job is ready. */
async function propose(): Promise<boolean> {
    const chosen = await choose();
    if (chosen === 'text') inJob = formText();
    if (chosen !== 'form') return chosen === 'text';
    return post('init', formText(), 'Proposing the job …', 'values');
}

/** Adapts with the form and the job as they stand, unless something is wrong or open. */
async function run(): Promise<void> {
    if (state && !state.is_fixed) {
        const wrong = isEdited ? null : stock.wrong();
        if (wrong) return wrong.focus();
        if (formText() !== inJob && !(await propose())) return;
        const open = isEdited ? null : questions.open();
        if (asked) form.say(asked, null);
        asked = open && 'ofForm' in open ? open.ofForm : '';
        if (open && 'ofForm' in open) form.say(open.ofForm, open.help)?.focus();
        else if (open) {
            open.field.setAttribute('aria-invalid', 'true');
            open.field.focus();
        }
        if (open) return void (document.documentElement.dataset.state = 'ready');
    }
    await post('run', jobText(), 'Adapting and simulating …', 'run');
}

async function take(file: File | undefined): Promise<void> {
    if (file) await post(`program?${encodeURIComponent(file.name).replace(/%../g, '_')}`, file, `Reading ${file.name} …`, 'program');
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
    element('values').addEventListener('submit', async (event) => {
        event.preventDefault();
        if (!(await propose())) return;
        element<HTMLDetailsElement>('job-details').open = true;
        element('job-details').scrollIntoView({ block: 'nearest' });
    });
    element('questions').addEventListener('submit', (event) => {
        event.preventDefault();
        void run();
    });
    element('stock-fields').addEventListener('submit', (event) => {
        event.preventDefault();
        void run();
    });
    element('job').addEventListener('input', () => {
        isEdited = true;
        changed();
    });
    for (const button of document.querySelectorAll<HTMLButtonElement>('#conflict button')) {
        button.addEventListener('click', () => element<HTMLDialogElement>('conflict').close(button.value));
    }
    element('run').addEventListener('click', () => void run());
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
        isEdited = true;
        await run();
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
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const theme = (isDark: boolean) => (document.documentElement.dataset.theme = isDark ? 'dark' : 'light');
    theme(dark.matches);
    dark.addEventListener('change', () => theme(dark.matches));
    // The page is as dark as the report in it.
    addEventListener('message', ({ source, data }) => {
        if (source === element<HTMLIFrameElement>('report').contentWindow && typeof data?.isDark === 'boolean') theme(data.isDark);
    });
    controls();
    const arcfeed = document.getElementById('arcfeed-wasm')?.textContent;
    if (arcfeed) {
        element('where').textContent = 'arcfeed runs inside this page: nothing leaves it.';
        backend = await InPage.load(arcfeed);
        downloads();
        example();
    }
    show(JSON.parse(text(await backend.request('state'))), 'program');
}

void start();
