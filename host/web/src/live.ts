// A transmission that goes on: its state as the sender reports it, and the commands of the operator.

/** State at one moment, as host/src/web/snapshot.rs writes it; null is unknown. */
interface Snapshot {
    is_over: boolean;
    state: 'waiting' | 'sending' | 'stopped' | 'held' | 'sent' | 'aborted' | 'failed';
    words: string;
    elapsed_s: number;
    left_s: number;
    line: number | null;
    is_least: boolean;
    sent_line: number | null;
    block: string;
    characters: number;
    total: number;
    at_control: number | null;
    is_taken: boolean | null;
    stops: number;
    damaged: number | null;
    position: [number, number, number] | null;
    tip: [number, number, number] | null;
    axis: [number, number, number] | null;
    feed: number | null;
    override_percent: number | null;
    chip_ratio: number | null;
    alarm: string | null;
    journal: string | null;
    board: string | null;
    note: string | null;
}

export interface Follower {
    /** Shows where the machine is, with the direction of the tool's axis; null is unknown. */
    follow(line: number | null, place: [number, number, number] | null, axis: [number, number, number] | null): void;
}

const QUESTIONS: Record<string, string> = {
    resume: 'Resume sending? The machine may move.',
    abort: 'Abort after the block under way? The control continues with the blocks it has.',
};

const UNKNOWN = 'unknown';

function element<T extends HTMLElement>(id: string): T {
    return document.getElementById(id) as T;
}

export class Live {
    private readonly events = new EventSource('events');
    private readonly figures = new Map<string, HTMLElement>();
    private asked = '';

    constructor(private readonly viewer: Follower | null, private readonly unit: string) {
        this.events.addEventListener('message', ({ data }) => this.show(JSON.parse(data)));
        this.events.addEventListener('error', () => this.lost());
        element('hold').addEventListener('click', () => void this.command('hold'));
        for (const command of Object.keys(QUESTIONS)) element(command).addEventListener('click', () => this.ask(command));
        const question = element<HTMLDialogElement>('question');
        element('yes').addEventListener('click', () => {
            question.close();
            void this.command(this.asked);
        });
        element('no').addEventListener('click', () => question.close());
    }

    private show(now: Snapshot): void {
        element('live-state').textContent = now.is_over ? `ended: ${now.words}` : now.words;
        element('live-state').dataset.state = now.state;
        const goesOn = !now.is_over && now.state !== 'aborted' && now.state !== 'failed';
        element<HTMLButtonElement>('hold').disabled = !goesOn || now.state === 'held' || now.state === 'sent';
        element<HTMLButtonElement>('resume').disabled = !goesOn || now.state !== 'held';
        element<HTMLButtonElement>('abort').disabled = !goesOn;
        this.text('live-alarm', now.alarm && `ALARM ${now.alarm}`);
        this.text('live-note', now.note);
        element<HTMLProgressElement>('live-progress').value = now.characters / Math.max(now.total, 1);
        element('live-sent').textContent = `${now.characters} of ${now.total} characters`;
        const executed = now.is_least ? 'executes at least line' : 'executes line';
        const [words, line] = now.line === null ? ['sends line', now.sent_line] : [executed, now.line];
        element('live-line').textContent = line === null ? '' : `${words} ${line}`;
        element('live-block').textContent = now.block;
        this.values(now);
        if (element<HTMLInputElement>('follow').checked) this.viewer?.follow(line, now.tip ?? now.position, now.axis);
        if (now.is_over) this.events.close();
    }

    private values(now: Snapshot): void {
        const { unit } = this;
        const digits = unit === 'in' ? 4 : 3;
        const length = (value: number | undefined) => (value === undefined ? UNKNOWN : `${zero(value.toFixed(digits))} ${unit}`);
        const known = (value: number | null, text: (value: number) => string) => (value === null ? UNKNOWN : text(value));
        const taken = now.is_taken === null ? 'no DC1 yet' : now.is_taken ? 'DC1: it takes characters' : 'DC3: it takes none';
        const values: [string, string][] = [
            ...['X', 'Y', 'Z'].map((axis, index): [string, string] => [axis, length(now.position?.[index])]),
            ['Feed', known(now.feed, (feed) => `${feed.toFixed(unit === 'in' ? 2 : 0)} ${unit}/min`)],
            ['Override', known(now.override_percent, (percent) => `${percent} %`)],
            ['Chip load', known(now.chip_ratio, (ratio) => `${(100 * ratio).toFixed(1)} % of target`)],
            ['Elapsed', clock(now.elapsed_s)],
            ['Left', `${now.line === null ? 'at least' : 'about'} ${clock(now.left_s)}`],
            ['Control', taken],
            ['At the control', known(now.at_control, (count) => `${now.is_least ? 'at most ' : ''}${count} characters`)],
            ['Stops', String(now.stops)],
            ['Damaged', known(now.damaged, (count) => `${count} characters`)],
            ['Board', now.board ?? 'none'],
            ['Journal', now.journal ?? 'none'],
        ];
        for (const [name, value] of values) {
            let cell = this.figures.get(name);
            if (!cell) {
                const [group, title] = [document.createElement('div'), document.createElement('dt')];
                cell = document.createElement('dd');
                title.textContent = name;
                group.append(title, cell);
                element('live-figures').append(group);
                this.figures.set(name, cell);
            }
            if (cell.textContent !== value) cell.textContent = value;
        }
    }

    private text(id: string, text: string | null): void {
        element(id).hidden = !text;
        if (element(id).textContent !== (text ?? '')) element(id).textContent = text ?? '';
    }

    private ask(command: string): void {
        this.asked = command;
        element('question-text').textContent = QUESTIONS[command];
        element<HTMLDialogElement>('question').showModal();
        element('no').focus();
    }

    private async command(command: string): Promise<void> {
        try {
            const answer = await fetch('command', { method: 'POST', body: command });
            if (!answer.ok) this.text('live-note', await answer.text());
        } catch {
            this.lost();
        }
    }

    private lost(): void {
        if (this.events.readyState === EventSource.CLOSED && element('live-state').textContent?.startsWith('ended')) return;
        element('live-state').textContent = 'No connection to the sender: what is shown is old';
        for (const button of ['hold', 'resume', 'abort']) element<HTMLButtonElement>(button).disabled = true;
    }
}

/** Without the sign of a rounded zero. */
function zero(text: string): string {
    return text.replace(/^-(0\.0+)$/, '$1');
}

function clock(seconds: number): string {
    const whole = Math.round(seconds);
    const two = (value: number) => String(value).padStart(2, '0');
    const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
    return h > 0 ? `${h}:${two(m)}:${two(s)}` : `${m}:${two(s)}`;
}
