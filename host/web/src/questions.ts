// Open questions of a job as fields, and its text with the answers in their places.

export interface Question {
    key: string;
    line: number;
    column: number;
    help: string;
}

/** Questions with few answers. */
const CHOICES: Record<string, string[]> = { units: ['mm', 'inch'] };

/** Questions to an end mill that a field of the form answers. */
const OF_FORM: Record<string, string> = {
    'tool.diameter': 'tool',
    'tool.teeth': 'teeth',
    'law.feed_per_tooth': 'feed_per_tooth',
    'spindle.rev_per_min': 'spindle',
};

/** Text of a job with "?" for each open question; answers stay when the text is made anew. */
export class Questions {
    private text = '';
    private questions: Question[] = [];
    private readonly answers = new Map<string, string>();

    constructor(private readonly form: HTMLFormElement, changed: () => void) {
        form.addEventListener('input', ({ target }) => {
            const { name, value } = target as HTMLInputElement;
            this.answers.set(name, value.trim());
            (target as HTMLElement).setAttribute('aria-invalid', 'false');
            changed();
        });
    }

    /** Begins anew, for another program. */
    forget(): void {
        this.answers.clear();
    }

    /** Takes a job with its open questions. */
    take(text: string, questions: Question[]): void {
        [this.text, this.questions] = [text, questions];
        this.form.replaceChildren(...questions.filter((question) => !this.ofForm(question)).map((question) => this.field(question)));
    }

    /** Field of the form that answers a question. */
    private ofForm({ key }: Question): string | null {
        return /^kind = "end-mill"/m.test(this.text) ? OF_FORM[key] ?? null : null;
    }

    private field({ key, help }: Question): HTMLElement {
        const [label, hint] = [document.createElement('label'), document.createElement('span')];
        const choices = CHOICES[key];
        const input = document.createElement(choices ? 'select' : 'input');
        if (input instanceof HTMLSelectElement) input.append(new Option('choose', ''), ...choices.map((choice) => new Option(choice)));
        else input.autocomplete = 'off';
        input.name = key;
        input.value = this.answers.get(key) ?? '';
        hint.className = 'hint';
        hint.textContent = help;
        label.append(`${key} `, input, hint);
        return label;
    }

    /** The first open question: the name of its field in the form of the values, or its own field. */
    open(): { ofForm: string; help: string } | { field: HTMLElement } | null {
        for (const question of this.questions) {
            if (this.answers.get(question.key)) continue;
            const ofForm = this.ofForm(question);
            if (ofForm) return { ofForm, help: question.help };
            const field = this.form.elements.namedItem(question.key) as HTMLElement | null;
            if (field) return { field };
        }
        return null;
    }

    /** Text of the job with the answers. */
    answered(): string {
        const lines = this.text.split('\n');
        for (const { key, line, column } of [...this.questions].reverse()) {
            const answer = this.answers.get(key);
            if (!answer) continue;
            const characters = [...lines[line - 1]];
            characters.splice(column - 1, 3, toToml(key, answer));
            lines[line - 1] = characters.join('');
        }
        return lines.join('\n');
    }
}

/** An answer as TOML: numbers, truth values, lists and tables as they are, all else as text; its key may stand before it. */
function toToml(key: string, answer: string): string {
    const last = key.split('.').pop() ?? '';
    const [, value] = new RegExp(`^(?:${last}\\s*=)?\\s*(.*)$`, 's').exec(answer) ?? ['', answer];
    const isValue = /^([+-]?\d[\d_]*(\.\d+)?([eE][+-]?\d+)?|true|false|\[.*\]|\{.*\}|".*")$/s.test(value);
    return isValue ? value : JSON.stringify(value);
}
