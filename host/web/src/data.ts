// Data of a report, as host/src/report/page/viewer writes them (docs/report.md).

/** Version of the layout that this viewer reads. */
const SCHEMA = 1;

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
    tool: [number, number][];
    heights: { columns: number; lowest: [number, number]; step: number; cells: number; column: ColumnHead } | null;
    findings: Finding[];
    text_bytes: number;
}

export interface Finding {
    severity: 'alarm' | 'warning' | 'note';
    run: string;
    block: number;
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
    values: Float64Array;
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
    tool: [number, number][];
    heights: Heights | null;
    findings: Finding[];
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
    const heights = header.heights && { ...header.heights, values: take(header.heights.column, header.heights.cells).values };
    const lines = readLines(new TextDecoder().decode(bytes.subarray(at, at + header.text_bytes)));
    const { title, unit, tool, findings } = header;
    return { title, unit, runs, tool, heights, findings, lines };
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
