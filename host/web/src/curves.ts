// Curves of both runs along time or path, one below the other. Each picture has as many columns as pixels, with the least and the
// largest value in each: a peak of a millisecond stays visible in a run of hours.
import uPlot from 'uplot';
import { IS_RATIO, written } from './colors';
import type { Run } from './run';

export type Along = 'time' | 'path';

const HEIGHT = 130;

/** Colours of the runs, before and after; with contrast on light and on dark ground. */
const COLORS: Record<string, string> = { before: '#808890', after: '#d0402c' };

export interface Quantity {
    key: string;
    label: string;
    unit: string;
}

interface Plot {
    quantity: Quantity;
    plot: uPlot;
    marks: Map<Run, HTMLElement>;
}

export class Curves {
    private readonly plots: Plot[] = [];
    private along: Along = 'path';
    /** Places of the points of each run along the axis. */
    private places = new Map<Run, Float64Array>();
    private range: [number, number] = [0, 1];
    private colors = { text: '#000', grid: '#ccc', target: '#888' };
    /** The pointer has chosen a range since it was pressed. */
    private hasZoomed = false;
    /** Times that are marked. */
    private marked = new Map<Run, number>();

    /** `abscissa` is the place of a point along the axis, `pointed` is called with a place; `unit` is that of lengths. */
    constructor(
        private readonly parent: HTMLElement,
        private readonly runs: Run[],
        quantities: Quantity[],
        private readonly unit: string,
        private readonly abscissa: (run: Run, time: number, along: Along) => number,
        private readonly pointed: (place: number, along: Along, isClick: boolean) => void,
    ) {
        this.place();
        this.range = this.whole();
        quantities.forEach((quantity) => this.plots.push(this.create(quantity)));
        new ResizeObserver(() => this.resize()).observe(parent);
    }

    setAlong(along: Along): void {
        this.along = along;
        this.place();
        this.zoom(this.whole());
    }

    private place(): void {
        this.places = new Map(this.runs.map((run) => [run, run.time.map((time) => this.abscissa(run, time, this.along))]));
    }

    setColors(text: string, grid: string, target: string): void {
        this.colors = { text, grid, target };
        this.plots.forEach(({ plot }) => plot.redraw(false));
    }

    /** Marks these times. */
    mark(times: Map<Run, number>): void {
        this.marked = times;
        for (const { plot, marks } of this.plots) {
            for (const [run, mark] of marks) {
                const place = this.abscissa(run, times.get(run) ?? 0, this.along);
                const left = plot.valToPos(place, 'x');
                mark.hidden = !(left >= 0 && left <= plot.over.clientWidth);
                mark.style.transform = `translateX(${left}px)`;
            }
        }
    }

    private whole(): [number, number] {
        const ends = this.runs.map((run) => [run.begin, run.end].map((time) => this.abscissa(run, time, this.along)));
        const [low, high] = [Math.min(...ends.map(([low]) => low)), Math.max(...ends.map(([, high]) => high))];
        return high > low ? [low, high] : [low, low + 1];
    }

    private zoom(range: [number, number]): void {
        this.range = range;
        this.plots.forEach(({ quantity, plot }) => plot.setData(this.data(quantity, this.width()), true));
        // The scales are set in a microtask.
        queueMicrotask(() => this.mark(this.marked));
    }

    private width(): number {
        return Math.max(this.parent.clientWidth, 200);
    }

    private resize(): void {
        this.plots.forEach(({ quantity, plot }) => {
            if (plot.width === this.width()) return;
            plot.setSize({ width: this.width(), height: HEIGHT });
            plot.setData(this.data(quantity, this.width()), true);
        });
    }

    private create(quantity: Quantity): Plot {
        const figure = document.createElement('figure');
        const caption = document.createElement('figcaption');
        const runs = this.runs.filter((run) => run.columns.has(quantity.key));
        caption.textContent = `${quantity.label}${quantity.unit && `, ${quantity.unit}`}`;
        const box = document.createElement('div');
        box.setAttribute('role', 'img');
        box.setAttribute('aria-label', `${caption.textContent}: ${runs.map((run) => this.spoken(run, quantity.key)).join('; ')}`);
        figure.append(caption, box);
        this.parent.append(figure);
        const series = runs.flatMap((run): uPlot.Series[] => {
            const color = COLORS[run.name] ?? COLORS.after;
            return [{ stroke: color, width: 0, points: { show: false } }, { stroke: color, width: 1.5, points: { show: false } }];
        });
        const axis = { stroke: () => this.colors.text, grid: { stroke: () => this.colors.grid, width: 1 }, ticks: { show: false } };
        const plot = new uPlot({
            width: this.width(),
            height: HEIGHT,
            legend: { show: false },
            cursor: { points: { show: false }, y: false, drag: { x: true, y: false, setScale: false } },
            scales: { x: { time: false, range: () => this.range }, y: { range: (_plot, low, high) => uPlot.rangeNum(Math.min(low, 0), high, 0.1, true) } },
            axes: [{ ...axis, size: 28, values: (_plot, ticks) => ticks.map((tick, index) => (index === ticks.length - 1 ? `${tick} ${this.along === 'time' ? 's' : this.unit}` : String(tick))) }, { ...axis, size: 64, space: 22 }],
            series: [{}, ...series],
            bands: runs.map((run, index) => ({ series: [2 * index + 2, 2 * index + 1], fill: `${COLORS[run.name] ?? COLORS.after}70` })),
            hooks: {
                draw: [(plot) => IS_RATIO.has(quantity.key) && this.drawTarget(plot)],
                setSelect: [(plot) => {
                    const { left, width } = plot.select;
                    if (width < 4) return;
                    this.hasZoomed = true;
                    const [low, high] = [plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x')];
                    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
                    this.zoom([low, high]);
                }],
            },
        }, this.data(quantity, this.width()), box);
        plot.over.addEventListener('pointermove', (event) => {
            if (event.buttons === 0) this.pointed(plot.posToVal(event.offsetX, 'x'), this.along, false);
        });
        plot.over.addEventListener('pointerdown', () => (this.hasZoomed = false));
        plot.over.addEventListener('click', (event) => {
            if (event.detail === 1 && !this.hasZoomed) this.pointed(plot.posToVal(event.offsetX, 'x'), this.along, true);
        });
        plot.over.addEventListener('dblclick', () => this.zoom(this.whole()));
        const marks = this.runs.map((run): [Run, HTMLElement] => {
            const mark = document.createElement('div');
            mark.className = `moment ${run.name}`;
            plot.over.append(mark);
            return [run, mark];
        });
        return { quantity, plot, marks: new Map(marks) };
    }

    /** Line at the target, 1. */
    private drawTarget(plot: uPlot): void {
        const { ctx, bbox } = plot;
        const y = plot.valToPos(1, 'y', true);
        ctx.save();
        ctx.strokeStyle = this.colors.target;
        ctx.setLineDash([6, 4]);
        ctx.beginPath();
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
        ctx.stroke();
        ctx.restore();
    }

    private spoken(run: Run, key: string): string {
        let [low, high] = [Infinity, -Infinity];
        for (const value of run.columns.get(key)?.values ?? []) {
            if (value < low) low = value;
            if (value > high) high = value;
        }
        return low <= high ? `${run.name} ${written(low)} to ${written(high)}` : `${run.name} none`;
    }

    /** Least and largest value of each run in each column of pixels. */
    private data(quantity: Quantity, width: number): uPlot.AlignedData {
        const [low, high] = this.range;
        const bins = Math.max(Math.floor(width - 64), 50);
        const xs = Array.from({ length: bins }, (_, bin) => low + ((bin + 0.5) / bins) * (high - low));
        const data: (number | null)[][] = [xs];
        for (const run of this.runs) {
            const values = run.columns.get(quantity.key)?.values;
            const places = this.places.get(run);
            if (!values || !places) continue;
            const least = new Array<number | null>(bins).fill(null);
            const largest = new Array<number | null>(bins).fill(null);
            let end = places[0];
            for (let i = 1; i < run.points; i++) {
                const begin = end;
                end = places[i];
                if (Number.isNaN(values[i]) || end < low || begin > high) continue;
                const first = Math.max(Math.floor(((begin - low) / (high - low)) * bins), 0);
                const last = Math.min(Math.ceil(((end - low) / (high - low)) * bins) - 1, bins - 1);
                for (let bin = Math.min(first, bins - 1); bin <= Math.max(first, last) && bin < bins; bin++) {
                    least[bin] = Math.min(least[bin] ?? Infinity, values[i]);
                    largest[bin] = Math.max(largest[bin] ?? -Infinity, values[i]);
                }
            }
            data.push(least, largest);
        }
        return data as uPlot.AlignedData;
    }
}
