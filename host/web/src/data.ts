// Data of a report, as host/src/report/page/viewer writes them (docs/report.md).

/** Version of the layout that this viewer reads. */
const SCHEMA = 3;

/** Stored value that stands for "no value". */
const NONE = -0x80000000;

interface ColumnHead {
    name: string;
    unit: string;
    quantum: number;
}

interface Header {
    schema: number;
    title: string;
    unit: string;
    runs: { name: string; points: number; columns: ColumnHead[] }[];
    tools: [number, number][][];
    heights: HeightsHead | null;
    solids: { name: string; vertices: number; corners: number; columns: ColumnHead[]; values: { label: string; column: ColumnHead }[] }[];
    findings: Finding[];
    purposes: string[];
    text_bytes: number;
}

interface HeightsHead {
    columns: number;
    lowest: [number, number];
    step: number;
    cells: number;
    column: ColumnHead;
    frames: { count: number; changes: number; columns: ColumnHead[] };
}

export interface Finding {
    severity: 'alarm' | 'warning' | 'note';
    run: string;
    block: number;
    /** Time of the run, s; without it the beginning of the block. */
    at?: number;
    /** Place that is marked. */
    place?: [number, number, number];
    text: string;
}

export interface Column {
    unit: string;
    /** Values; NaN where there is none. */
    values: Float64Array;
}

export interface RunData {
    name: string;
    points: number;
    columns: Map<string, Column>;
}

export interface Heights {
    columns: number;
    lowest: [number, number];
    step: number;
    /** Before the run. */
    values: Float64Array;
    frames: Frames;
}

/** Changes of the heights at some times of the run. */
export interface Frames {
    at: Float64Array;
    /** Number of changes up to and including each frame. */
    end: Float64Array;
    cell: Float64Array;
    height: Float64Array;
}

/** Solid as triangles. */
export interface Solid {
    name: string;
    x: Float64Array;
    y: Float64Array;
    z: Float64Array;
    /** Three vertices of each triangle. */
    corners: Float64Array;
    /** Values at the vertices, by which the solid can be coloured. */
    values: SurfaceValue[];
}

export interface SurfaceValue {
    label: string;
    column: Column;
}

export interface Line {
    text: string;
    /** Blocks as sent, if they differ. */
    sent: string[] | null;
}

export interface ReportData {
    title: string;
    unit: string;
    runs: RunData[];
    /** Closed outlines: pairs of radius and height above the tip. */
    tools: [number, number][][];
    heights: Heights | null;
    solids: Solid[];
    findings: Finding[];
    /** Names of the values of the column `purpose`. */
    purposes: string[];
    lines: Line[];
}

/** Reads the block of data in the page. */
export async function read(base64: string): Promise<ReportData> {
    const coded = atob(base64.trim());
    const packed = new Uint8Array(coded.length);
    for (let index = 0; index < packed.length; index++) packed[index] = coded.charCodeAt(index);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const length = new DataView(bytes.buffer).getUint32(0, true);
    const header: Header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
    if (header.schema !== SCHEMA) throw new Error(`the data have layout ${header.schema}, this viewer reads ${SCHEMA}`);
    let at = 4 + length;
    const take = (head: ColumnHead, count: number): Column => {
        const column = { unit: head.unit, values: decode(bytes.subarray(at, at + 4 * count), count, head.quantum) };
        at += 4 * count;
        return column;
    };
    const runs = header.runs.map(({ name, points, columns }) => {
        const read = columns.map((head): [string, Column] => [head.name, take(head, points)]);
        return { name, points, columns: new Map(read) };
    });
    const heights = header.heights && readHeights(header.heights, take);
    const solids = header.solids.map(({ name, vertices, corners, columns, values }) => {
        const [x, y, z, of] = columns.map((head, index) => take(head, index < 3 ? vertices : corners).values);
        return { name, x, y, z, corners: of, values: values.map(({ label, column }) => ({ label, column: take(column, vertices) })) };
    });
    const lines = readLines(new TextDecoder().decode(bytes.subarray(at, at + header.text_bytes)));
    const { title, unit, tools, findings, purposes } = header;
    return { title, unit, runs, tools, heights, solids, findings, purposes, lines };
}

function readHeights(head: HeightsHead, take: (head: ColumnHead, count: number) => Column): Heights {
    const { columns, lowest, step, frames } = head;
    const values = take(head.column, head.cells).values;
    const [at, end, cell, height] = frames.columns.map((head, index) => take(head, index < 2 ? frames.count : frames.changes).values);
    return { columns, lowest, step, values, frames: { at, end, cell, height } };
}

/** Sums of the differences, whose bytes stand in four planes. */
function decode(planes: Uint8Array, count: number, quantum: number): Float64Array {
    const values = new Float64Array(count);
    // Quanta are powers of ten: dividing by the whole number keeps decimals exact.
    const perUnit = Math.round(1 / quantum);
    for (let row = 0, sum = 0; row < count; row++) {
        const [a, b, c, d] = [planes[row], planes[count + row], planes[2 * count + row], planes[3 * count + row]];
        sum = (sum + (a | (b << 8) | (c << 16) | (d << 24))) | 0;
        values[row] = sum === NONE ? NaN : sum / perUnit;
    }
    return values;
}

function readLines(text: string): Line[] {
    const lines = text.split('\n').slice(1);
    return lines.map((line) => {
        const [own, sent] = line.split('\x1f');
        return { text: own, sent: sent === undefined ? null : sent.split('\x1e') };
    });
}
