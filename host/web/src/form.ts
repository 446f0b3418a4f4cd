// Form of the start page: a row of fields for each tool, values for `arcfeed init`, and what is wrong with them.

/** Tool of the program, as `arcfeed init` proposes it. */
export interface ProposedTool {
    number: number | null;
    kind: string;
    diameter: number | null;
    teeth: number | null;
    comment_line: number | null;
}

/** Value of the form that cannot be used. */
export interface Problem {
    field: string;
    /** T number of the tool, if the value is for one of several. */
    tool: number | null;
    text: string;
}

/** Fields that each tool has: label, and what an empty field means without a value in the program. */
const TOOL_FIELDS: [string, string, string][] = [
    ['tool', 'Diameter', 'Such as 10, 10mm or 0.5in.'],
    ['teeth', 'Teeth', 'A whole number; needed with a feed per tooth.'],
    ['feed_per_tooth', 'Feed per tooth at the contour', 'Empty: the programmed F is the feed at the contour.'],
];

const FIELDS: Record<string, string> = {
    spindle: "Empty: the program's S.",
    max: '100 to 250. Empty: outside arcs keep their F.',
};

export class Form {
    private readonly form: HTMLFormElement;
    private tools: ProposedTool[] = [];

    constructor(form: HTMLFormElement, changed: () => void) {
        this.form = form;
        for (const [name, hint] of Object.entries(FIELDS)) addHint(this.field(name), name, hint);
        form.addEventListener('input', ({ target }) => {
            if (target instanceof HTMLInputElement) this.say(target.name, null);
            changed();
        });
    }

    /** Begins anew, with a row for each tool of a program. */
    begin(tools: ProposedTool[], unit: string): void {
        this.form.reset();
        this.tools = tools.length > 0 ? tools : [{ number: null, kind: '', diameter: null, teeth: null, comment_line: null }];
        const rows = document.getElementById('tools') as HTMLElement;
        rows.replaceChildren(...this.tools.map((tool) => this.row(tool, unit)));
        for (const name of Object.keys(FIELDS)) this.say(name, null);
    }

    private row(tool: ProposedTool, unit: string): HTMLElement {
        const row = document.createElement('fieldset');
        const legend = document.createElement('legend');
        legend.textContent = tool.number === null ? 'Tool' : `T${tool.number}`;
        row.append(legend, ...TOOL_FIELDS.map(([name, title, hint]) => {
            const [label, input] = [document.createElement('label'), document.createElement('input')];
            input.name = this.nameOf(name, tool.number);
            input.autocomplete = 'off';
            const found = name === 'tool' ? tool.diameter : name === 'teeth' ? tool.teeth : null;
            if (found !== null) input.placeholder = `${found}${name === 'tool' ? ` ${unit}` : ''}`;
            label.append(`${title} `, input);
            const where = tool.comment_line === null ? '' : ` of line ${tool.comment_line}`;
            addHint(input, input.name, found === null ? hint : `Empty: ${found}, from the comment${where}.`);
            return label;
        }));
        return row;
    }

    /** Name of a field of a tool: with the T number if there are several. */
    private nameOf(field: string, tool: number | null): string {
        return this.tools.length > 1 && tool !== null ? `${field}.${tool}` : field;
    }

    private field(name: string): HTMLInputElement | null {
        return this.form.elements.namedItem(name) as HTMLInputElement | null;
    }

    /** Values as `arcfeed view` takes them: of several tools T1=10 T3=6. */
    values(): Record<string, string> {
        const value = (name: string) => this.field(name)?.value.trim() ?? '';
        const values = Object.fromEntries(['spindle', 'max', 'mode', 'milling'].map((name) => [name, value(name)]));
        for (const [name] of TOOL_FIELDS) {
            values[name] = this.tools.map(({ number }) => {
                const own = this.nameOf(name, number);
                const text = value(own).replace(/\s+/g, '');
                return text && own !== name ? `T${number}=${text}` : text;
            }).filter((text) => text).join(' ');
        }
        return values;
    }

    /** Shows what is wrong at its fields, and goes to the first; whether there is any. */
    refuse(problems: Problem[]): boolean {
        const fields = problems.map(({ field, tool, text }) => this.say(this.nameOf(field, tool), text));
        fields.find((field) => field)?.focus();
        return problems.length > 0;
    }

    /** Says something at a field in place of its hint, or its hint again. */
    say(name: string, problem: string | null): HTMLInputElement | null {
        const [field, hint] = [this.field(name), document.getElementById(`hint-${name}`)];
        if (!field || !hint) return null;
        hint.textContent = problem ?? hint.dataset.hint ?? '';
        hint.classList.toggle('problem', problem !== null);
        field.setAttribute('aria-invalid', String(problem !== null));
        return field;
    }
}

function addHint(field: HTMLElement | null, name: string, words: string): void {
    const hint = document.createElement('span');
    hint.className = 'hint';
    hint.id = `hint-${name}`;
    hint.dataset.hint = hint.textContent = words;
    field?.setAttribute('aria-describedby', hint.id);
    field?.after(hint);
}
