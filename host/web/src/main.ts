// The viewer of a report: one moment, shown in the path, in the curves and in the NC text.
import './viewer.css';
import { aboutOne, IS_RATIO, Scale, valueAbout, written, type ScaleName } from './colors';
import { Curves, type Along, type Quantity } from './curves';
import { read, type Column, type Finding, type ReportData } from './data';
import { Listing } from './listing';
import { Live, type Follower } from './live';
import { Measure, type Place } from './measure';
import { Pairing, Run } from './run';
import { PathScene, type ViewName } from './scene';

type Shown = 'before' | 'after' | 'both';

/** Columns that are drawn as curves and colours, in this order. */
const LABELS: [string, string][] = [
    ['chip', 'Chip load over its target'],
    ['contour', 'Feed at the contour over its target'],
    ['feed', 'Feed'],
    ['override', 'Override'],
    ['force', 'Force across the axis, largest in 0.25 s'],
    ['power', 'Mean power in the cut'],
    ['removal', 'Removal rate'],
];

/** Heads of the table where the key is none. */
const SHORT: Record<string, string> = { chip: 'Chip / target', contour: 'At contour / target' };

/** Samples of two runs lie a millisecond apart at most, and on a ramp the feed changes by a tenth within one. */
const SAMPLE_S = 1.5e-3;

/** Difference of two feeds at one place that their stored intervals leave open: one per cent each. */
const FEED_RESOLUTION = 0.021;

/** Mean change of the feed from which a line counts as changed. */
const LINE_CHANGE = 0.1;

const AXES = ['X', 'Y', 'Z'];
const AXIS_COLORS = ['#c8321e', '#2c8a3c', '#2f6fd0'];
const VIEWS: ViewName[] = ['iso', 'XY', 'XZ', 'YZ'];

function element<T extends HTMLElement>(id: string): T {
    const found = document.getElementById(id);
    if (!found) throw new Error(`the page has no #${id}`);
    return found as T;
}

class Viewer implements Follower {
    private readonly runs: Run[];
    private readonly quantities: Quantity[];
    private readonly pairing: Pairing | null;
    private readonly scene: PathScene | null;
    /** Absent until the first picture. */
    private curves?: Curves;
    private listing?: Listing;
    private readonly ranges = new Map<string, [number, number]>();
    /** The moment: a time of this run. */
    private run: Run;
    private time: number;
    private shown: Shown = 'after';
    private along: Along = 'path';
    private playing = 0;
    private finding = -1;
    /** Places that are being measured. */
    private measure: Measure | null = null;
    /** The moment stays where a click has put it: pointing moves it again after the next click. */
    private isHeld = false;
    /** What the last call of `follow` has shown. */
    private followed = '';

    constructor(private readonly data: ReportData) {
        this.runs = data.runs.map((run) => new Run(run)).filter((run) => run.points > 1);
        if (this.runs.length === 0) throw new Error('the run has no move');
        this.run = this.runs[this.runs.length - 1];
        this.time = this.run.begin;
        this.pairing = this.runs.length === 2 ? new Pairing(this.runs[0], this.runs[1]) : null;
        if (this.pairing) this.addRatios();
        this.quantities = LABELS.flatMap(([key, label]) => {
            const column = this.runs.map((run) => run.columns.get(key)).find((column) => column);
            // A run without an override has no curve of it.
            const isIdle = key === 'override' && this.runs.every((run) => run.columns.get(key)?.values.every((value) => value === 100 || Number.isNaN(value)) !== false);
            return column && !isIdle ? [{ key, label, unit: column.unit }] : [];
        });
        element('viewer').hidden = false;
        this.scene = this.createScene();
        this.controls();
        this.theme(matchMedia('(prefers-color-scheme: dark)').matches);
        this.show(this.runs.length === 2 ? 'after' : (this.run.name as Shown));
        this.paint();
        const cutting = this.run.rapid.findIndex((rapid, index) => index > 0 && rapid === 0);
        this.time = this.run.middle(Math.max(cutting, 1));
        this.moveTools();
        this.scene?.render();
    }

    /** Adds what needs more time than the path: the stock, the curves, the text, the findings. */
    complete(): void {
        this.curves = new Curves(element('curves'), this.runs, this.quantities, this.data.unit, this.abscissa, (place, along, isClick) => this.point(this.timeAt(place, along), isClick));
        this.restyle();
        this.listing = new Listing(element('listing'), this.data.lines, (line, isPointed) => this.pointLine(line, isPointed));
        this.listing.setSlowed(this.feedChanges());
        this.listing.setSide(this.shown === 'before' ? 'before' : 'after');
        this.findings();
        this.select(this.run, this.time, 'start');
    }

    private createScene(): PathScene | null {
        const canvas = element<HTMLCanvasElement>('path');
        try {
            let pointer: PointerEvent | null = null;
            const scene = new PathScene(canvas, this.data, this.runs, () => this.drawTriad());
            canvas.addEventListener('pointermove', (event) => {
                if (event.buttons !== 0 || this.isFixed()) return;
                // The pointer moves more often than a picture is drawn.
                if (!pointer) requestAnimationFrame(() => {
                    const found = pointer && scene.pick(pointer.clientX, pointer.clientY);
                    pointer = null;
                    if (found) this.select(found.run, found.time, 'scene');
                });
                pointer = event;
            });
            canvas.addEventListener('click', (event) => {
                if (this.measure) return this.measurePlace(scene.placeAt(event.clientX, event.clientY));
                const found = scene.pick(event.clientX, event.clientY);
                if (found && this.hold()) this.select(found.run, found.time, 'scene');
            });
            return scene;
        } catch {
            canvas.hidden = true;
            element('no-scene').hidden = false;
            return null;
        }
    }

    /** Feed over that of the other run at the same place, as a colour. */
    private addRatios(): void {
        const [before, after] = this.runs;
        for (const [run, other] of [[after, before], [before, after]]) {
            const feeds = [run, other].map((run) => run.columns.get('feed')?.values);
            const values = new Float64Array(run.points).fill(NaN);
            if (!feeds[0] || !feeds[1]) return;
            for (let i = 1; i < run.points; i++) {
                const [feed, place] = [feeds[0][i], this.pairing?.map(run, run.middle(i)) ?? NaN];
                const near = (values: Float64Array, of: Run, time: number) => [-SAMPLE_S, 0, SAMPLE_S].map((shift) => values[of.indexAt(time + shift)]);
                const [own, others] = [near(feeds[0], run, run.middle(i)), near(feeds[1], other, place)];
                const [low, high] = [Math.min(...others), Math.max(...others)];
                // Where both have the same feed within a sample, none is raised or lowered.
                const factor = Math.min(...own) > high ? feed / high : Math.max(...own) < low ? feed / low : feed + low + high > 0 ? 1 : NaN;
                const ratio = run === after ? factor : 1 / factor;
                values[i] = !Number.isFinite(ratio) ? NaN : Math.abs(ratio - 1) <= FEED_RESOLUTION ? 1 : ratio;
            }
            run.columns.set('ratio', { unit: '', values });
        }
    }

    /** Lines whose feed after is another one than before. */
    private feedChanges(): Set<number> {
        const last = this.runs[this.runs.length - 1];
        const ratios = last.columns.get('ratio')?.values ?? [];
        const lines = new Set<number>();
        const feeds = new Map<number, [number, number]>();
        for (let i = 1; i < last.points && ratios.length > 0; i++) {
            if (Number.isNaN(ratios[i])) continue;
            // Feed times ratio is summed over the line: a ramp behind a slow arc alone does not change a line.
            const sums = feeds.get(last.line[i]) ?? [0, 0];
            const length = last.length[i] - last.length[i - 1];
            feeds.set(last.line[i], [sums[0] + length * ratios[i], sums[1] + length]);
        }
        feeds.forEach(([sum, length], line) => Math.abs(sum / length - 1) > LINE_CHANGE && lines.add(line));
        return lines;
    }

    /** Place along the axis of the curves. Along the path, both runs have the path of the last one. */
    private readonly abscissa = (run: Run, time: number, along: Along): number => {
        if (along === 'time') return time - run.begin;
        const last = this.runs[this.runs.length - 1];
        return last.lengthAt(run === last || !this.pairing ? time : this.pairing.map(run, time));
    };

    private timeAt(place: number, along: Along): number {
        if (along === 'time') return this.run.begin + place;
        const last = this.runs[this.runs.length - 1];
        const time = last.timeAtLength(place);
        return this.run === last || !this.pairing ? time : this.pairing.map(last, time);
    }

    private timeOf(run: Run): number {
        return run === this.run || !this.pairing ? this.time : this.pairing.map(this.run, this.time);
    }

    /** Whether pointing does not move the moment. */
    private isFixed(): boolean {
        return this.isHeld || this.measure !== null;
    }

    /** A click holds the moment, the next one lets it follow the pointer again; always true. */
    private hold(isHeld = !this.isHeld): boolean {
        this.isHeld = isHeld;
        element('held').hidden = !isHeld;
        return true;
    }

    private point(time: number, isClick: boolean): void {
        if (isClick) this.hold();
        else if (this.isFixed()) return;
        this.select(this.run, time, 'curves');
    }

    private pointLine(line: number, isPointed = false): void {
        if (isPointed && this.isFixed()) return;
        const index = this.run.ofLine.get(line);
        if (index !== undefined) this.select(this.run, this.run.middle(index), 'listing');
    }

    /** Shows where the machine is: at the place, or in the first move of the line. Does nothing while nothing changes. */
    follow(line: number | null, place: [number, number, number] | null, axis: [number, number, number] | null): void {
        const { run } = this;
        const state = () => JSON.stringify([this.run.name, this.time, line, place, axis]);
        if (state() === this.followed) return;
        const first = line === null ? undefined : run.ofLine.get(line);
        if (first !== undefined) this.select(run, place ? run.nearest(first, place) : run.middle(first), 'machine');
        else if (line !== null) this.listing?.mark(line, true);
        if (place) this.scene?.moveTool(run, place, run.toolAt(run.indexAt(this.time)), axis ?? undefined);
        this.followed = state();
    }

    /** Makes this the moment everywhere. */
    private select(run: Run, time: number, source: 'scene' | 'curves' | 'listing' | 'scrub' | 'start' | 'machine'): void {
        this.run = run;
        this.time = Math.min(Math.max(time, run.begin), run.end);
        this.moveTools();
        this.scene?.moveStock(this.timeOf(this.runs[this.runs.length - 1]));
        this.curves?.mark(new Map(this.runs.map((run) => [run, this.timeOf(run)])));
        const index = run.indexAt(this.time);
        const line = run.line[index];
        this.listing?.mark(Number.isNaN(line) ? 0 : line, source !== 'listing');
        const scrub = element<HTMLInputElement>('scrub');
        scrub.min = String(run.begin);
        scrub.max = String(run.end);
        scrub.value = String(this.time);
        const place = Number.isNaN(line) ? '' : `, line ${line}`;
        scrub.setAttribute('aria-valuetext', `${(this.time - run.begin).toFixed(2)} s of ${run.name}${place}`);
        this.values();
    }

    private moveTools(): void {
        for (const run of this.runs) {
            const time = this.timeOf(run);
            this.scene?.moveTool(run, run.placeAt(time), run.toolAt(run.indexAt(time)), run.axisAt(time));
        }
    }

    /** Table with the values of the moment. */
    private values(): void {
        const cell = (tag: string, text: string) => {
            const cell = document.createElement(tag);
            cell.textContent = text;
            return cell;
        };
        const row = (cells: HTMLElement[]) => {
            const row = document.createElement('tr');
            row.append(...cells);
            return row;
        };
        const { unit } = this.data;
        const heads = ['', 'Time, s', ...AXES.map((axis) => `${axis}, ${unit}`), 'Line'];
        const titles = this.quantities.map(({ key, label, unit }) => {
            const head = cell('th', `${SHORT[key] ?? key[0].toUpperCase() + key.slice(1)}${unit && `, ${unit}`}`);
            head.title = label;
            return head;
        });
        const ths = [...heads.map((text) => cell('th', text)), ...titles];
        ths.slice(1).forEach((head) => head.setAttribute('scope', 'col'));
        ths[0] = cell('td', '');
        element('values-head').replaceChildren(row(ths));
        const rows = this.runs.map((run) => {
            const time = this.timeOf(run);
            const [index, place] = [run.indexAt(time), run.placeAt(time)];
            const name = cell('th', run.name);
            name.setAttribute('scope', 'row');
            const line = run.line[index];
            const digits = unit === 'in' ? 4 : 3;
            const texts = [
                (time - run.begin).toFixed(3),
                ...place.map((value) => value.toFixed(digits).replace(/^-(0\.0+)$/, '$1')),
                Number.isNaN(line) ? '–' : String(line),
                ...this.quantities.map(({ key }) => written(run.columns.get(key)?.values[index] ?? NaN)),
            ];
            return row([name, ...texts.map((text) => cell('td', text))]);
        });
        element('values').replaceChildren(...rows);
    }

    /** Least and largest value of a quantity over both runs. */
    private range(key: string): [number, number] {
        const known = this.ranges.get(key);
        if (known) return known;
        let [low, high] = [Infinity, -Infinity];
        for (const run of this.runs) {
            const values = run.columns.get(key)?.values ?? [];
            for (let i = 1; i < run.points; i++) {
                if (run.rapid[i] !== 0) continue;
                if (values[i] < low) low = values[i];
                if (values[i] > high) high = values[i];
            }
        }
        const range: [number, number] = low <= high ? [low, high] : [0, 1];
        this.ranges.set(key, range);
        return range;
    }

    /** Values by which a solid can be coloured, each with the index of its solid. */
    private surfaces(): { index: number; label: string; column: Column }[] {
        return this.data.solids.flatMap(({ values }, index) => values.map((value) => ({ index, ...value })));
    }

    private paint(): void {
        const key = element<HTMLSelectElement>('quantity').value;
        const isRatio = IS_RATIO.has(key);
        element<HTMLSelectElement>('scale').disabled = isRatio;
        const chosenScale = element<HTMLSelectElement>('scale').value as ScaleName;
        const scale = new Scale(isRatio ? 'diverging' : chosenScale);
        const { purposes } = this.data;
        const [low, high] = key === 'purpose' ? [0, purposes.length - 1] : this.range(key);
        const span = high - low || 1;
        const part = (value: number) => (isRatio ? aboutOne(value, [low, high]) : (value - low) / span);
        for (const run of this.runs) {
            const values = run.columns.get(key)?.values;
            this.scene?.paint(run, (index) => scale.color(values ? part(values[index]) : NaN));
        }
        const chosen = element<HTMLSelectElement>('quantity').selectedOptions[0]?.textContent ?? '';
        const texts = ticks((part) => (isRatio ? valueAbout([low, high], part) : low + part * (high - low)));
        this.legend('legend', `${chosen}${isRatio ? '; 1 is right, blue is less, red is more' : ''}`, scale, key === 'purpose' ? purposes : texts);
        const range = key === 'purpose' ? purposes.join(', ') : `from ${written(low)} to ${written(high)}`;
        element('path').setAttribute('aria-label', `Path of the tool, coloured by ${chosen}: ${range}`);
        this.paintSurface(new Scale(chosenScale));
    }

    /** Colours a solid by the chosen value, from its least to its largest one. */
    private paintSurface(scale: Scale): void {
        const chosen = this.surfaces()[element<HTMLSelectElement>('surface').selectedIndex];
        if (!chosen) return;
        const { index, label, column } = chosen;
        const known = column.values.filter((value) => !Number.isNaN(value));
        const [low, high] = [known.reduce((a, b) => Math.min(a, b), Infinity), known.reduce((a, b) => Math.max(a, b), -Infinity)];
        this.scene?.paintSolid(index, column.values, (value) => scale.color((value - low) / (high - low || 1)));
        this.legend('surface-legend', `${label}, ${column.unit}`, scale, known.length > 0 ? ticks((part) => low + part * (high - low)) : []);
    }

    private legend(id: string, title: string, scale: Scale, texts: string[]): void {
        element(`${id}-title`).textContent = `${title}; grey: no value`;
        element(`${id}-bar`).style.background = scale.gradient();
        element(`${id}-ticks`).replaceChildren(...texts.map((text) => Object.assign(document.createElement('span'), { textContent: text })));
    }

    private show(shown: Shown): void {
        this.shown = shown;
        document.querySelectorAll<HTMLElement>('#show button').forEach((button) => {
            button.setAttribute('aria-pressed', String(button.dataset.show === shown));
        });
        const runs = shown === 'both' ? this.runs : this.runs.filter((run) => run.name === shown);
        this.scene?.show(runs);
        element('names').replaceChildren(...runs.map((run) => {
            const name = document.createElement('span');
            name.textContent = run.name;
            return name;
        }));
        this.listing?.setSide(shown === 'before' ? 'before' : 'after');
        if (!runs.includes(this.run)) this.select(runs[0], this.timeOf(runs[0]), 'scrub');
    }

    private theme(isDark: boolean): void {
        // The page around the report.
        if (parent !== window) parent.postMessage({ isDark }, '*');
        document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
        element('theme').setAttribute('aria-pressed', String(isDark));
        this.restyle();
    }

    private restyle(): void {
        const style = getComputedStyle(document.documentElement);
        const color = (name: string) => style.getPropertyValue(name).trim();
        this.scene?.setBackground(color('--scene'));
        this.curves?.setColors(color('--text'), color('--line'), color('--muted'));
    }

    private drawTriad(): void {
        const axes = this.scene?.axes() ?? [];
        element('triad').innerHTML = axes.map(([x, y], index) => {
            const [color, length] = [AXIS_COLORS[index], 30];
            // An axis that points at the eye has no direction for its letter.
            const far = Math.hypot(x, y) > 0.2 ? 40 : 0;
            const letter = far ? `<text x="${far * x}" y="${far * y + 5}" text-anchor="middle" fill="${color}">${AXES[index]}</text>` : '';
            return `<line x2="${length * x}" y2="${length * y}" stroke="${color}" stroke-width="3"/>${letter}`;
        }).join('');
    }

    private controls(): void {
        const quantity = element<HTMLSelectElement>('quantity');
        const choices = [...this.quantities, ...(this.pairing ? [{ key: 'ratio', label: 'Feed after over feed before', unit: '' }] : [])];
        if (this.data.purposes.length > 0) choices.push({ key: 'purpose', label: 'Purpose of the move', unit: '' });
        choices.push({ key: 'time', label: 'Time', unit: 's' });
        quantity.replaceChildren(...choices.map(({ key, label, unit }) => new Option(`${label}${unit && `, ${unit}`}`, key)));
        quantity.addEventListener('change', () => this.paint());
        element('scale').addEventListener('change', () => this.paint());
        const surface = element<HTMLSelectElement>('surface');
        surface.replaceChildren(...this.surfaces().map(({ label, column }) => new Option(`${label}, ${column.unit}`)));
        surface.addEventListener('change', () => this.paint());
        element('surface-label').hidden = surface.options.length === 0;
        element('surface-legend').hidden = surface.options.length === 0;
        document.querySelectorAll<HTMLElement>('#show button').forEach((button) => {
            button.hidden = this.runs.length < 2;
            button.addEventListener('click', () => this.show(button.dataset.show as Shown));
        });
        document.querySelectorAll<HTMLElement>('#views button').forEach((button) => {
            button.addEventListener('click', () => this.scene?.view(button.dataset.view as ViewName));
        });
        for (const what of ['rapids', 'tool', 'stock'] as const) {
            const box = element<HTMLInputElement>(what);
            box.addEventListener('change', () => this.scene?.setVisible(what, box.checked));
        }
        element('stock-label').hidden = !this.data.heights && this.data.solids.length === 0;
        if (!this.data.heights) element('stock-name').textContent = 'Part';
        document.querySelectorAll<HTMLElement>('#curves-bar .key').forEach((key) => (key.hidden = this.runs.length < 2));
        element('measure').addEventListener('click', () => this.toggleMeasure());
        element('theme').addEventListener('click', () => this.theme(document.documentElement.dataset.theme !== 'dark'));
        const along = element<HTMLSelectElement>('along');
        along.addEventListener('change', () => {
            this.along = along.value as Along;
            this.curves?.setAlong(this.along);
            this.select(this.run, this.time, 'scrub');
        });
        const scrub = element<HTMLInputElement>('scrub');
        scrub.addEventListener('input', () => this.select(this.run, Number(scrub.value), 'scrub'));
        scrub.addEventListener('change', () => this.hold(true));
        element('play').addEventListener('click', () => this.play());
        element('search').addEventListener('submit', (event) => {
            event.preventDefault();
            const line = this.listing?.find(element<HTMLInputElement>('find').value);
            element('found').textContent = line ? `line ${line}` : 'not found';
            if (line) this.pointLine(line);
        });
        element('viewer').addEventListener('keydown', (event) => this.key(event));
        addEventListener('beforeprint', () => this.restyle());
        addEventListener('afterprint', () => this.restyle());
    }

    private toggleMeasure(): void {
        this.measure = this.measure ? null : new Measure();
        element('measure').setAttribute('aria-pressed', String(this.measure !== null));
        element('measured').hidden = !this.measure;
        this.measurePlace(null);
    }

    private measurePlace(place: Place | null): void {
        if (place) this.measure?.take(place);
        this.scene?.rule(this.measure?.places ?? []);
        element('measured').textContent = this.measure?.text(this.data.unit) ?? '';
    }

    private findings(): void {
        const list = element('findings');
        const { findings } = this.data;
        if (findings.length === 0) {
            const none = document.createElement('li');
            none.textContent = 'No alarms, limits or warnings.';
            list.append(none);
        }
        findings.forEach((finding, index) => {
            const [item, button, severity] = [document.createElement('li'), document.createElement('button'), document.createElement('span')];
            severity.className = `severity ${finding.severity}`;
            severity.textContent = finding.severity;
            button.append(severity, ` ${finding.run}: ${finding.text}`);
            button.addEventListener('click', () => this.goTo(index));
            item.append(button);
            list.append(item);
        });
    }

    private goTo(index: number): void {
        const finding: Finding | undefined = this.data.findings[index];
        const run = this.runs.find((run) => run.name === finding?.run);
        if (!finding || !run) return;
        if (this.playing) this.play();
        this.finding = index;
        const buttons = document.querySelectorAll<HTMLElement>('#findings button');
        buttons.forEach((button, at) => button.setAttribute('aria-current', String(at === index)));
        buttons[index]?.scrollIntoView({ block: 'nearest' });
        if (this.shown !== 'both' && this.shown !== run.name) this.show(run.name as Shown);
        this.select(run, finding.at ?? run.timeOfBlock(finding.block), 'scrub');
        this.scene?.mark(finding.place ?? null);
        element('scene').scrollIntoView({ block: 'nearest' });
    }

    private play(): void {
        const button = element('play');
        if (this.playing) {
            cancelAnimationFrame(this.playing);
            this.playing = 0;
            button.textContent = '▶';
            button.setAttribute('aria-label', 'Play');
            return;
        }
        button.textContent = '⏸';
        button.setAttribute('aria-label', 'Pause');
        if (this.time >= this.run.end) this.select(this.run, this.run.begin, 'scrub');
        let last = performance.now();
        const frame = (now: number) => {
            const speed = Number(element<HTMLSelectElement>('speed').value);
            this.select(this.run, this.time + ((now - last) / 1000) * speed, 'scrub');
            last = now;
            if (this.time >= this.run.end) this.play();
            else this.playing = requestAnimationFrame(frame);
        };
        this.playing = requestAnimationFrame(frame);
    }

    private step(points: number): void {
        const index = this.run.indexAt(this.time) + points;
        this.select(this.run, this.run.middle(Math.min(Math.max(index, 1), this.run.points - 1)), 'scrub');
    }

    private key(event: KeyboardEvent): void {
        const target = event.target as HTMLElement;
        const isTyping = target.matches('input[type="search"], select') || event.ctrlKey || event.altKey || event.metaKey;
        const isOwn = target.matches('input') && event.key.startsWith('Arrow');
        if (isTyping || isOwn || ([' ', 'Enter'].includes(event.key) && target.matches('button, summary, input'))) return;
        if (event.key === 'Enter' && !this.measure) return;
        const press = (id: string) => element(id).click();
        const next = (id: string) => {
            const select = element<HTMLSelectElement>(id);
            select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
            select.dispatchEvent(new Event('change'));
        };
        const count = this.data.findings.length;
        const actions: Record<string, () => void> = {
            ArrowLeft: () => this.step(event.shiftKey ? -10 : -1),
            ArrowRight: () => this.step(event.shiftKey ? 10 : 1),
            ' ': () => this.play(),
            b: () => this.runs.length === 2 && this.show('before'),
            a: () => this.runs.length === 2 && this.show('after'),
            s: () => this.runs.length === 2 && this.show('both'),
            c: () => next('quantity'),
            x: () => next('along'),
            Escape: () => this.measure ? this.toggleMeasure() : this.hold(false),
            d: () => press('theme'),
            m: () => press('measure'),
            Enter: () => this.measurePlace(this.run.placeAt(this.time)),
            n: () => count > 0 && this.goTo((this.finding + 1) % count),
            p: () => count > 0 && this.goTo((this.finding - 1 + count) % count),
        };
        VIEWS.forEach((view, index) => (actions[String(index + 1)] = () => this.scene?.view(view)));
        const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
        if (!action) return;
        event.preventDefault();
        action();
    }
}

/** Five numbers from the least to the largest one. */
function ticks(value: (part: number) => number): string[] {
    return [0, 0.25, 0.5, 0.75, 1].map((part) => written(value(part)));
}

/** Time after which a page that is not seen, and gets no pictures, goes on, ms. */
const UNSEEN = 250;

/** The next picture is on its way to the screen. */
function picture(): Promise<void> {
    return new Promise((done) => {
        setTimeout(done, UNSEEN);
        requestAnimationFrame(() => setTimeout(done));
    });
}

async function start(): Promise<void> {
    const state = element('viewer-state');
    const isLive = document.getElementById('live') !== null;
    document.body.classList.toggle('is-live', isLive);
    let [data, viewer]: [ReportData | null, Viewer | null] = [null, null];
    try {
        data = await read(element('arcfeed-data').textContent ?? '');
        performance.mark('data');
        viewer = new Viewer(data);
        await picture();
        performance.mark('picture');
        viewer.complete();
        performance.mark('complete');
        state.remove();
        document.documentElement.dataset.viewer = 'ready';
    } catch (error) {
        element('viewer').hidden = true;
        state.textContent = `The viewer cannot show this run (${error instanceof Error ? error.message : error}); the figures are below.`;
        if (!isLive) throw error;
    }
    if (isLive) new Live(viewer, data?.unit ?? '');
}

void start();
