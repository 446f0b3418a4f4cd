// The report of a plan in a real browser: `node test/plan.mjs REPORT.html FACTS.json [PICTURE.png]`. The facts are figures of `plan --json`.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { accessible, launch, open, pixels, watch } from './browser.mjs';

const [report, factsFile, screenshot] = process.argv.slice(2);
const facts = JSON.parse(readFileSync(factsFile, 'utf8'));
const { browser, page } = await launch({ width: 1200, height: 1000 });
const { messages, requests } = watch(page);
const text = (selector) => page.locator(selector).innerText();

/** X, Y, Z of the tool. */
const tool = () => page.evaluate(() => {
    const heads = [...document.querySelectorAll('#values-head tr > *')].map((cell) => cell.textContent);
    const cells = [...document.querySelectorAll('#values tr > *')].map((cell) => Number(cell.textContent));
    return ['X', 'Y', 'Z'].map((axis) => cells[heads.findIndex((head) => head.startsWith(axis))]);
});

/** Direction of the tool's axis at the moment, as the list of moves has it; without that it stands along Z. */
const axisShown = async () => {
    const found = /axis (\S+) (\S+) (\S+)/.exec(await text('.row.current'));
    return found ? found.slice(1).map(Number) : [0, 0, 1];
};

/** Distance of a point from a closed outline that turns about the tool's axis. */
function distance(point, tip, axis, outline) {
    const from = point.map((value, index) => value - tip[index]);
    const h = from.reduce((sum, value, index) => sum + value * axis[index], 0);
    const r = Math.sqrt(Math.max(from.reduce((sum, value) => sum + value * value, 0) - h * h, 0));
    const ways = outline.map(([r1, h1], index) => {
        const [r2, h2] = outline[(index + 1) % outline.length];
        const square = (r2 - r1) ** 2 + (h2 - h1) ** 2;
        const part = square > 0 ? Math.min(Math.max(((r - r1) * (r2 - r1) + (h - h1) * (h2 - h1)) / square, 0), 1) : 0;
        return Math.hypot(r1 + part * (r2 - r1) - r, h1 + part * (h2 - h1) - h);
    });
    return Math.min(...ways);
}

/** Text of a closest place. */
const CLOSEST = /^(\w+) to (\w+)(?:, (?:plunge|move) \d+)?: certified (-?[\d.]+) \w+, (found|needed) (-?[\d.]+) \w+$/;

/** Header of the data: findings with their places, the tool. */
async function header() {
    return page.evaluate(async () => {
        const packed = Uint8Array.from(atob(document.getElementById('arcfeed-data').textContent), (letter) => letter.charCodeAt(0));
        const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
        const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
        const length = new DataView(bytes.buffer).getUint32(0, true);
        return JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
    });
}

try {
    await open(page, report);
    const drawn = await pixels(page);
    console.log(`picture: ${drawn.drawn} pixels drawn in ${drawn.colors} colours`);
    assert.ok(drawn.drawn > 20_000 && drawn.colors > 20, 'the picture is empty');
    await page.locator('#stock').uncheck();
    assert.notDeepEqual((await pixels(page)).counts, drawn.counts, 'the part stays');
    await page.locator('#stock').check();
    const { findings, tools: [outline], solids, unit, purposes } = await header();
    const mm = unit === 'in' ? 25.4 : 1;
    console.log(`${solids[0].corners / 3} triangles, ${findings.length} findings`);
    const buttons = page.locator('#findings button');
    if (facts.turns !== undefined) assert.equal(await buttons.count(), facts.clearances.length + facts.turns);
    assert.ok(findings.filter(({ place }) => place).length > 0, 'closest places');
    let last = -Infinity;
    for (const [index, { place, text: words }] of findings.entries()) {
        if (!place) continue;
        await buttons.nth(index).click();
        // The others may be behind, or where the tool is already.
        if (last === -Infinity) assert.notDeepEqual((await pixels(page)).counts, drawn.counts, words);
        const [, part, obstacle, certified, kind, other] = CLOSEST.exec(words);
        const fact = facts.clearances.find((fact) => fact.part === part && fact.obstacle === obstacle);
        for (const [shown, wanted] of [[certified, fact.certified_mm], [other, fact[`${kind}_mm`]]]) assert.ok(Math.abs(shown * mm - wanted) < 1e-3 * mm, words);
        const order = kind === 'found' ? Number(certified) : certified - other;
        assert.ok(order >= last - 2e-3, 'in order of the distance');
        last = order;
        // Another part of the tool may be nearer to this point; the outline of a cup mill has no corner radius.
        const near = distance(place, await tool(), await axisShown(), outline);
        console.log(`${words}: ${near.toFixed(4)} ${unit} from the drawn outline`);
        if (kind === 'found') assert.ok(near <= Number(other) + 0.02 / mm, words);
        // In the middle of the move, which is short; farther distances have no sharp bound.
        else if (order < 1) assert.ok(near <= Number(certified) + facts.move_mm, words);
    }
    // A step of the path, by the list in the place of the NC text.
    await page.locator('#find').fill(facts.find);
    await page.locator('#search button').click();
    assert.ok((await text('.row.current')).includes(facts.find));
    await page.locator('#quantity').selectOption('purpose');
    assert.deepEqual((await text('#legend-ticks')).split('\n'), purposes);
    await page.locator('#quantity').selectOption('feed');
    // The maps of a repair, on the blade.
    assert.deepEqual(await page.locator('#surface option').allInnerTexts(), facts.surfaces ?? []);
    if (facts.surfaces) {
        const map = await pixels(page);
        await page.locator('#surface').selectOption({ index: 2 });
        assert.notDeepEqual((await pixels(page)).counts, map.counts, 'the colours of the blade stay');
        assert.match(await text('#surface-legend'), /Depth to be taken, mm/);
    } else {
        assert.ok(await page.locator('#surface-legend').isHidden());
    }
    for (const theme of ['light', 'dark']) {
        await accessible(page, theme);
        await page.locator('#theme').click();
    }
    if (screenshot) {
        await buttons.first().click();
        await page.evaluate(() => scrollTo(0, 0));
        await page.screenshot({ path: screenshot });
    }
    assert.deepEqual(messages, [], 'messages on the console');
    assert.deepEqual(requests.filter((url) => !/^(file|data|blob):/.test(url)), [], 'requests');
} finally {
    await browser.close();
}
