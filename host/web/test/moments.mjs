// Moments of a report's runs, the stock in the last one, by the viewer's own code without a browser: `node test/moments.mjs REPORT.html FACTS.json`. A fact is a line
// of the program, the part of its way that is done, and what is there then: place and axis of the tool, its reach, heights of the stock.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { build } from 'esbuild';

const [report, factsFile] = process.argv.slice(2);
const facts = JSON.parse(readFileSync(factsFile, 'utf8'));
const source = "export { read } from './data'; export { Run } from './run'; export { Stock } from './stock';";
const stdin = { contents: source, resolveDir: join(import.meta.dirname, '../src'), loader: 'ts' };
const { outputFiles: [bundle] } = await build({ stdin, bundle: true, format: 'esm', write: false });
const { read, Run, Stock } = await import(`data:text/javascript;base64,${Buffer.from(bundle.contents).toString('base64')}`);

const [, data] = /id="arcfeed-data">([^<]*)</.exec(readFileSync(report, 'utf8'));
const page = await read(data);
const runs = page.runs.map((shown) => new Run(shown));
const run = runs.at(-1);
const stock = page.heights && new Stock(page.heights, run, page.tools);
if (stock) console.log(`${page.heights.frames.at.length} frames, ${page.heights.frames.cell.length} changes of ${page.heights.values.length} cells`);

const close = (actual, wanted, tolerance, what) =>
    actual.forEach((value, axis) => assert.ok(Math.abs(value - wanted[axis]) <= tolerance, `${what}: ${actual}, not ${wanted}`));

/** Height of the stock at a place, in the cell that has it. */
function height([x, y]) {
    const { columns, lowest, step } = page.heights;
    return stock.values[Math.floor((y - lowest[1]) / step) * columns + Math.floor((x - lowest[0]) / step)];
}

/** Time at which a run has done a part of a line's way. */
function timeOf(run, line, part) {
    const begin = run.ofLine.get(line) - 1;
    let end = begin + 1;
    while (end + 1 < run.points && run.line[end + 1] === line) end++;
    return run.timeAtLength(run.length[begin] + part * (run.length[end] - run.length[begin]));
}

for (const { line, part, place, axis, reach, heights, tolerance } of facts) {
    const [time, what] = [timeOf(run, line, part), `line ${line} at ${part}`];
    for (const shown of runs) {
        const at = timeOf(shown, line, part);
        if (place) close(shown.placeAt(at), place, tolerance, what);
        if (axis) close(shown.axisAt(at), axis, 1e-5, `axis in ${what}`);
    }
    if (reach) {
        const outline = page.tools[run.toolAt(run.indexAt(time))];
        close([Math.max(...outline.map(([radius]) => radius))], [reach], 1e-6, `tool in ${what}`);
    }
    // Back and forth: any moment may follow any other.
    for (const first of heights ? [run.begin, run.end] : []) {
        stock.moveTo(first);
        stock.moveTo(time);
        for (const [x, y, wanted] of heights) close([height([x, y])], [wanted], tolerance, `height at X${x} Y${y} in ${what}`);
    }
}
console.log(`${facts.length} moments`);
