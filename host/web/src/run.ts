// A run as a function of time, and the same place in another run.
import type { Column, RunData } from './data';

/** First index whose value is not below `value`. */
export function lowerBound(values: ArrayLike<number>, value: number): number {
    let [low, high] = [0, values.length];
    while (low < high) {
        const middle = (low + high) >> 1;
        if (values[middle] < value) low = middle + 1;
        else high = middle;
    }
    return low;
}

export class Run {
    readonly name: string;
    readonly points: number;
    readonly columns: Map<string, Column>;
    readonly time: Float64Array;
    readonly place: [Float64Array, Float64Array, Float64Array];
    readonly block: Float64Array;
    readonly line: Float64Array;
    readonly rapid: Float64Array;
    /** Direction of the tool's axis; without it the tool stands along Z. */
    readonly axis: [Float64Array, Float64Array, Float64Array] | null;
    private readonly tools: Float64Array | null;
    /** Path length from the beginning. */
    readonly length: Float64Array;
    /** First point of each stretch of one line. */
    readonly starts: number[] = [];
    /** First point of each line, by its number. */
    readonly ofLine = new Map<number, number>();

    constructor({ name, points, columns }: RunData) {
        this.name = name;
        this.points = points;
        this.columns = columns;
        const column = (key: string) => columns.get(key)?.values ?? new Float64Array(points).fill(NaN);
        this.time = column('time');
        this.place = [column('x'), column('y'), column('z')];
        this.block = column('block');
        this.line = column('line');
        this.rapid = column('rapid');
        this.axis = columns.has('i') ? [column('i'), column('j'), column('k')] : null;
        this.tools = columns.get('tool')?.values ?? null;
        this.length = new Float64Array(points);
        const [x, y, z] = this.place;
        for (let i = 1; i < points; i++) {
            this.length[i] = this.length[i - 1] + Math.hypot(x[i] - x[i - 1], y[i] - y[i - 1], z[i] - z[i - 1]);
        }
        for (let i = 1; i < points; i++) {
            if (i === 1 || !Object.is(this.line[i], this.line[i - 1])) this.starts.push(i);
            if (this.line[i] > 0 && !this.ofLine.has(this.line[i])) this.ofLine.set(this.line[i], i);
        }
    }

    get begin(): number {
        return this.time[0] ?? 0;
    }

    get end(): number {
        return this.time[this.points - 1] ?? 0;
    }

    /** Point whose interval has this time: values hold on the way to it. */
    indexAt(time: number): number {
        return Math.min(Math.max(lowerBound(this.time, time), Math.min(1, this.points - 1)), this.points - 1);
    }

    /** Time in the middle of the way to a point. */
    middle(index: number): number {
        return index > 0 ? (this.time[index - 1] + this.time[index]) / 2 : this.begin;
    }

    placeAt(time: number): [number, number, number] {
        const i = this.indexAt(time);
        const part = this.part(i, time);
        return this.place.map((axis) => (i > 0 ? axis[i - 1] + (axis[i] - axis[i - 1]) * part : axis[i])) as [number, number, number];
    }

    /** Direction from the tip to the holder on the way to a point. */
    axisAt(time: number): [number, number, number] {
        if (!this.axis) return [0, 0, 1];
        const i = this.indexAt(time);
        const part = this.part(i, time);
        return this.axis.map((axis) => (i > 0 ? axis[i - 1] + (axis[i] - axis[i - 1]) * part : axis[i])) as [number, number, number];
    }

    isUpright(index: number): boolean {
        return !this.axis || this.axis[2][index] > 1 - 1e-9;
    }

    /** Index of the tool on the way to a point; -1 if its shape is not known. */
    toolAt(index: number): number {
        const tool = this.tools ? this.tools[index] : 0;
        return Number.isNaN(tool) ? -1 : tool;
    }

    /** Time of the place nearest to another one, among the moves of the line that begins at a point. */
    nearest(first: number, [x, y, z]: [number, number, number]): number {
        let best = { distance: Infinity, time: this.middle(first) };
        for (let i = first; i < this.points && Object.is(this.line[i], this.line[first]); i++) {
            const from = this.place.map((axis) => axis[i - 1]);
            const way = this.place.map((axis, k) => axis[i] - from[k]);
            const offset = [x - from[0], y - from[1], z - from[2]];
            const dot = (a: number[], b: number[]) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            const length = dot(way, way);
            const part = length > 0 ? Math.min(Math.max(dot(offset, way) / length, 0), 1) : 0;
            const distance = Math.hypot(...offset.map((value, k) => value - part * way[k]));
            if (distance < best.distance) best = { distance, time: this.time[i - 1] + part * (this.time[i] - this.time[i - 1]) };
        }
        return best.time;
    }

    lengthAt(time: number): number {
        const i = this.indexAt(time);
        return i > 0 ? this.length[i - 1] + (this.length[i] - this.length[i - 1]) * this.part(i, time) : 0;
    }

    timeAtLength(length: number): number {
        const i = Math.min(Math.max(lowerBound(this.length, length), 1), this.points - 1);
        const way = this.length[i] - this.length[i - 1];
        const part = way > 0 ? Math.min(Math.max((length - this.length[i - 1]) / way, 0), 1) : 1;
        return this.time[i - 1] + (this.time[i] - this.time[i - 1]) * part;
    }

    /** First time of a block, or of the next one that moves. */
    timeOfBlock(block: number): number {
        const index = Math.max(1, lowerBound(this.block, block));
        return this.middle(Math.min(index, this.points - 1));
    }

    private part(index: number, time: number): number {
        if (index === 0) return 1;
        const span = this.time[index] - this.time[index - 1];
        return span > 0 ? Math.min(Math.max((time - this.time[index - 1]) / span, 0), 1) : 1;
    }
}

/** Places of two runs that belong together: the same line, and the same part of the path in it. */
export class Pairing {
    private readonly anchors: [number[], number[]];
    private readonly runs: [Run, Run];

    constructor(first: Run, second: Run) {
        this.runs = [first, second];
        const same = first.starts.length === second.starts.length
            && first.starts.every((start, index) => Object.is(first.line[start], second.line[second.starts[index]]));
        // Runs that do not execute the same lines are compared by the part of the whole path.
        const anchors = (run: Run) => [...(same ? run.starts.map((start) => start - 1) : [0]), run.points - 1];
        this.anchors = [anchors(first), anchors(second)];
    }

    /** Time in the other run at the same place of the path. */
    map(run: Run, time: number): number {
        const from = run === this.runs[0] ? 0 : 1;
        const [other, own, others] = [this.runs[1 - from], this.anchors[from], this.anchors[1 - from]];
        const index = run.indexAt(time);
        const group = Math.max(0, Math.min(lowerBound(own, index) - 1, own.length - 2));
        const [a, b] = [own[group], own[group + 1] ?? own[group]];
        const [c, d] = [others[group], others[group + 1] ?? others[group]];
        const [way, otherWay] = [run.length[b] - run.length[a], other.length[d] - other.length[c]];
        if (way > 0 && otherWay > 0) {
            const part = (run.lengthAt(time) - run.length[a]) / way;
            const found = other.timeAtLength(other.length[c] + part * otherWay);
            return Math.min(Math.max(found, other.time[c]), other.time[d]);
        }
        const span = run.time[b] - run.time[a];
        const part = span > 0 ? Math.min(Math.max((time - run.time[a]) / span, 0), 1) : 1;
        return other.time[c] + part * (other.time[d] - other.time[c]);
    }
}
