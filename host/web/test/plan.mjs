// The report of a planned slot in a real browser: `node test/plan.mjs REPORT.html FACTS.json [PICTURE.png]`. The facts are figures of `plan --json`.
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

/** Distance of a point from a closed outline that turns about the tool's axis, which stands along Z. */
function distance([x, y, z], [tx, ty, tz], outline) {
    const [r, h] = [Math.hypot(x - tx, y - ty), z - tz];
    const ways = outline.map(([r1, h1], index) => {
        const [r2, h2] = outline[(index + 1) % outline.length];
        const square = (r2 - r1) ** 2 + (h2 - h1) ** 2;
        const part = square > 0 ? Math.min(Math.max(((r - r1) * (r2 - r1) + (h - h1) * (h2 - h1)) / square, 0), 1) : 0;
        return Math.hypot(r1 + part * (r2 - r1) - r, h1 + part * (h2 - h1) - h);
    });
    return Math.min(...ways);
}

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
    const { findings, tools: [outline], solids, unit } = await header();
    const mm = unit === 'in' ? 25.4 : 1;
    console.log(`${solids[0].corners / 3} triangles, ${findings.length} findings`);
    const buttons = page.locator('#findings button');
    assert.equal(await buttons.count(), facts.clearances.length + facts.turns);
    let last = -Infinity;
    for (const [index, { place, text: words }] of findings.entries()) {
        if (!place) continue;
        await buttons.nth(index).click();
        // The others may be behind, or where the tool is already.
        if (last === -Infinity) assert.notDeepEqual((await pixels(page)).counts, drawn.counts, words);
        const [, part, obstacle, certified, found] = /^(\w+) to (\w+): certified (-?[\d.]+) \w+, found (-?[\d.]+) \w+$/.exec(words);
        const fact = facts.clearances.find((fact) => fact.part === part && fact.obstacle === obstacle);
        for (const [shown, wanted] of [[certified, fact.certified_mm], [found, fact.found_mm]]) assert.ok(Math.abs(shown * mm - wanted) < 1e-3 * mm, words);
        assert.ok(Number(certified) >= last, 'in order of the distance');
        last = Number(certified);
        // Another part of the tool may be nearer to this point; the outline has no corner radius.
        const near = distance(place, await tool(), outline);
        console.log(`${words}: ${near.toFixed(4)} ${unit} from the drawn outline`);
        assert.ok(near <= Number(found) + 0.02 / mm, words);
    }
    // A step of the path, by the list in the place of the NC text.
    await page.locator('#find').fill('level 2: movement 2');
    await page.locator('#search button').click();
    assert.match(await text('.row.current'), /level 2: movement 2, about A/);
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
