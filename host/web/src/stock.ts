// The stock at any time of a run: heights at key frames (docs/report.md), and between two of them the cut of the upright tool along
// the path, as far as the next frame has it.
import type { Heights } from './data';
import { lowerBound, type Run } from './run';

/** Most places of the tool between two frames at which cells are cut. */
const PLACES_MAX = 400;
/** Radii at which the bottom of a tool is known. */
const RADII = 128;

/** Lowest height of a tool's outline above the tip, by radius. */
interface Bottom {
    reach: number;
    heights: Float64Array;
}

export class Stock {
    /** Heights at the moment; NaN where nothing is left. */
    readonly values: Float64Array;
    /** Heights at the frame before the moment. */
    private readonly base: Float64Array;
    private frame = 0;
    private readonly bottoms: Bottom[];

    constructor(private readonly heights: Heights, private readonly run: Run, tools: [number, number][][]) {
        this.base = Float64Array.from(heights.values);
        this.values = Float64Array.from(heights.values);
        this.bottoms = tools.map(bottom);
    }

    /** Lowest and highest material of the whole run. */
    range(): [number, number] {
        let [low, high] = [Infinity, -Infinity];
        for (const values of [this.heights.values, this.heights.frames.height]) {
            for (const value of values) {
                if (value < low) low = value;
                if (value > high) high = value;
            }
        }
        return [low, high];
    }

    /** Moves the moment. */
    moveTo(time: number): void {
        const { at } = this.heights.frames;
        // Frames up to this one are over.
        let past = lowerBound(at, time);
        if (at[past] === time) past += 1;
        if (past < this.frame) {
            this.base.set(this.heights.values);
            this.frame = 0;
        }
        for (; this.frame < past; this.frame++) this.apply(this.frame, this.base);
        this.values.set(this.base);
        if (past < at.length) this.cut(past, past > 0 ? at[past - 1] : this.run.begin, time);
    }

    private span(frame: number): [number, number] {
        const { end } = this.heights.frames;
        return [frame > 0 ? end[frame - 1] : 0, end[frame]];
    }

    private apply(frame: number, values: Float64Array): void {
        const { cell, height } = this.heights.frames;
        const [from, to] = this.span(frame);
        for (let index = from; index < to; index++) values[cell[index]] = height[index];
    }

    /** Cuts the cells that the next frame changes, by the path since the one before; not deeper than there. */
    private cut(frame: number, from: number, to: number): void {
        const { run, values } = this;
        const { columns, lowest, step, frames } = this.heights;
        const [begin, end] = this.span(frame);
        const length = run.lengthAt(to) - run.lengthAt(from);
        const places = Math.min(Math.ceil(length / step) + 1, PLACES_MAX);
        for (let index = 0; index <= places; index++) {
            const time = run.timeAtLength(run.lengthAt(from) + (length * index) / places);
            const point = run.indexAt(time);
            const bottom = this.bottoms[run.toolAt(point)];
            if (!bottom || !run.isUpright(point)) continue;
            const [x, y, z] = run.placeAt(time);
            const perRadius = (RADII - 1) / bottom.reach;
            for (let change = begin; change < end; change++) {
                const cell = frames.cell[change];
                const dx = lowest[0] + ((cell % columns) + 0.5) * step - x;
                const dy = lowest[1] + (Math.floor(cell / columns) + 0.5) * step - y;
                const radius = Math.hypot(dx, dy);
                if (radius > bottom.reach) continue;
                const height = z + bottom.heights[Math.round(radius * perRadius)];
                if (!(height < values[cell])) continue;
                const left = frames.height[change];
                values[cell] = Number.isNaN(left) ? height : Math.max(height, left);
            }
        }
    }
}

/** Least height at which a vertical line at each radius meets the outline. */
function bottom(outline: [number, number][]): Bottom {
    const reach = outline.reduce((most, [radius]) => Math.max(most, radius), 1e-9);
    const heights = new Float64Array(RADII).fill(Infinity);
    outline.forEach((corner, index) => {
        const other = outline[(index + 1) % outline.length];
        const [[r1, h1], [r2, h2]] = corner[0] <= other[0] ? [corner, other] : [other, corner];
        const bin = (radius: number) => (radius * (RADII - 1)) / reach;
        for (let at = Math.ceil(bin(r1) - 1e-9); at <= bin(r2) + 1e-9; at++) {
            const radius = (at * reach) / (RADII - 1);
            const height = r2 > r1 ? h1 + ((h2 - h1) * (radius - r1)) / (r2 - r1) : Math.min(h1, h2);
            if (height < heights[at]) heights[at] = height;
        }
    });
    return { reach, heights };
}
