// Fields for a stock: the box around the cutting path with a margin, as a [workpiece] of the job.

const NAMES = ['margin', 'above', 'below'] as const;

/** Cells along the longest edge of the box. */
const CELLS = 200;

export type Extents = ([number, number] | null)[];

export class StockFields {
    /** Lowest and highest X, Y, Z of the cutting path. */
    extents: Extents = [];

    constructor(private readonly form: HTMLElement, changed: () => void) {
        form.addEventListener('input', changed);
    }

    private field(name: string): HTMLInputElement {
        return this.form.querySelector(`[name=stock_${name}]`) as HTMLInputElement;
    }

    clear(): void {
        for (const name of NAMES) this.field(name).value = '';
    }

    /** The first field that is no length from 0 on, if any. */
    wrong(): HTMLInputElement | null {
        const fields = NAMES.map((name) => this.field(name));
        const isWrong = ({ value }: HTMLInputElement) => value.trim() !== '' && !/^\d*\.?\d+$|^\d+\.$/.test(value.trim());
        fields.forEach((field) => field.setAttribute('aria-invalid', String(isWrong(field))));
        return fields.find(isWrong) ?? null;
    }

    /** The job with its stock; the job itself without a margin, or with a stock of its own. */
    added(job: string): string {
        const margin = this.field('margin').value.trim();
        const [x, y, z] = this.extents;
        if (!margin || this.wrong() || !x || !y || !z || /^\[workpiece\]/m.test(job)) return job;
        const number = (name: string) => Number(this.field(name).value.trim() || 0);
        const radii = [...job.matchAll(/^diameter = "?([\d.]+)/gm)].map(([, diameter]) => Number(diameter) / 2);
        const beside = Math.max(0, ...radii) + Number(margin);
        const from = [x[0] - beside, y[0] - beside, z[0] - number('below')];
        const to = [x[1] + beside, y[1] + beside, number('above')];
        const longest = Math.max(...to.map((end, axis) => end - from[axis]));
        const list = (values: number[]) => values.map((value) => Number(value.toFixed(4))).join(', ');
        const step = Number((longest / CELLS).toPrecision(2));
        // The edge cuts over the whole height of the box: a shorter edge is the shop's to write.
        const height = Number((to[2] - from[2]).toFixed(4));
        const withHeight = /^height =/m.test(job) ? job : job.replace(/^diameter = .*$/gm, `$&\nheight = ${height}`);
        return `${withHeight.trimEnd()}\n\n# The box around the path of the cutting edge, of the form.\n[workpiece]\nblock = { from = [${list(from)}], to = [${list(to)}] }\nstep = ${step}\n`;
    }
}
