// The NC text: only the rows in view exist, so that long programs scroll as short ones.
import type { Line } from './data';

/** Height of a row, as in viewer.css. */
const ROW = 20;

/** Most height that browsers lay out exactly. */
const HEIGHT_MAX = 8e6;

export type Side = 'before' | 'after';

export class Listing {
    private readonly space = document.createElement('div');
    private readonly rows = new Map<number, HTMLElement>();
    private side: Side = 'after';
    private current = 0;
    private found = 0;
    /** Lines with another feed, also by an F before them. */
    private changed = new Set<number>();
    /** The pointer has moved since the list scrolled by itself. */
    private hasPointer = true;

    /** `pointed` is called with the number of a line, and whether the pointer only rests on it. */
    constructor(private readonly box: HTMLElement, private readonly lines: Line[], private readonly pointed: (line: number, isPointed?: boolean) => void) {
        this.space.className = 'space';
        this.space.setAttribute('role', 'presentation');
        this.space.style.height = `${this.height()}px`;
        box.append(this.space);
        box.addEventListener('scroll', () => this.fill());
        box.addEventListener('pointermove', () => (this.hasPointer = true));
        box.addEventListener('keydown', (event) => this.key(event));
        new ResizeObserver(() => this.fill()).observe(box);
    }

    setSide(side: Side): void {
        this.side = side;
        this.rows.forEach((row) => row.remove());
        this.rows.clear();
        this.fill();
    }

    setSlowed(lines: Set<number>): void {
        this.changed = lines;
    }

    /** Marks a line, counted from 1, and brings it into view if asked. */
    mark(line: number, isToBeSeen: boolean): void {
        if (line === this.current) return;
        this.current = line;
        if (isToBeSeen) this.reveal(line);
        this.rows.forEach((row, index) => this.setCurrent(row, index));
        if (line > 0) this.box.setAttribute('aria-activedescendant', `line-${line}`);
    }

    /** Goes to the next line that contains the text, with its last number as a whole if there is one; returns it, or 0. */
    find(text: string): number {
        const wanted = text.trim().toUpperCase();
        if (!wanted) return 0;
        // A word of the program is not the beginning of another one: N70 is not N700.
        const escaped = wanted.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
        const word = new RegExp(`(^|[^A-Z])${escaped}(?![0-9.])`);
        return this.next((text) => word.test(text)) || this.next((text) => text.includes(wanted));
    }

    private next(isIt: (text: string) => boolean): number {
        const count = this.lines.length;
        for (let step = 1; step <= count; step++) {
            const index = (this.found - 1 + step + count) % count;
            if (isIt(this.text(index).toUpperCase())) {
                this.found = index + 1;
                this.reveal(this.found);
                return this.found;
            }
        }
        return 0;
    }

    private text(index: number): string {
        const { text, sent } = this.lines[index];
        return this.side === 'after' && sent ? sent.join(' ⏎ ') : text;
    }

    private height(): number {
        return Math.min(this.lines.length * ROW, HEIGHT_MAX);
    }

    /** First row in view. Beyond the largest height, the scroll bar is coarser than a row. */
    private first(): number {
        const whole = this.lines.length * ROW - this.box.clientHeight;
        const range = this.height() - this.box.clientHeight;
        return Math.floor((this.box.scrollTop * (range > 0 ? whole / range : 1)) / ROW);
    }

    private reveal(line: number): void {
        const visible = Math.floor(this.box.clientHeight / ROW);
        const first = this.first();
        if (line > first + 1 && line < first + visible - 1) return;
        const range = this.height() - this.box.clientHeight;
        const whole = this.lines.length * ROW - this.box.clientHeight;
        this.hasPointer = false;
        this.box.scrollTop = Math.max((line - visible / 2) * ROW, 0) * (whole > 0 ? range / whole : 1);
        this.fill();
    }

    private fill(): void {
        const first = Math.max(this.first() - 2, 0);
        const last = Math.min(first + Math.ceil(this.box.clientHeight / ROW) + 4, this.lines.length);
        this.rows.forEach((row, index) => {
            if (index >= first && index < last) return;
            row.remove();
            this.rows.delete(index);
        });
        const shift = this.box.scrollTop - this.first() * ROW;
        for (let index = first; index < last; index++) {
            const row = this.rows.get(index) ?? this.create(index);
            const top = this.lines.length * ROW > HEIGHT_MAX ? index * ROW + shift : index * ROW;
            row.style.transform = `translateY(${top}px)`;
        }
    }

    private create(index: number): HTMLElement {
        const row = document.createElement('div');
        const { text, sent } = this.lines[index];
        row.className = sent ? 'row changed' : this.changed.has(index + 1) ? 'row inherits' : 'row';
        row.id = `line-${index + 1}`;
        row.setAttribute('role', 'option');
        const number = document.createElement('span');
        number.className = 'number';
        number.textContent = String(index + 1);
        const code = document.createElement('span');
        code.textContent = this.text(index) || ' ';
        row.append(number, code);
        if (sent) row.title = `before: ${text}\nafter: ${sent.join('\n')}`;
        else if (this.changed.has(index + 1)) row.title = 'the feed is another one by an F of a line before it';
        row.addEventListener('pointerenter', (event) => event.buttons === 0 && this.hasPointer && this.pointed(index + 1, true));
        row.addEventListener('click', () => this.pointed(index + 1));
        this.setCurrent(row, index);
        this.rows.set(index, row);
        this.space.append(row);
        return row;
    }

    private setCurrent(row: HTMLElement, index: number): void {
        const isCurrent = index + 1 === this.current;
        row.classList.toggle('current', isCurrent);
        row.setAttribute('aria-selected', String(isCurrent));
    }

    private key(event: KeyboardEvent): void {
        const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        event.stopPropagation();
        const line = Math.min(Math.max(this.current + step, 1), this.lines.length);
        this.pointed(line);
        this.mark(line, true);
        this.reveal(line);
    }
}
