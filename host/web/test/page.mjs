// A report in a real browser: `node test/page.mjs REPORT.html FACTS.json [PICTURE.png]`. The facts are figures of `simulate --json`, and what
// is known about the program itself: a line, the places and the chips on it.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { accessible, launch, inPicture, open, pixels, watch } from './browser.mjs';

const [report, factsFile, screenshot] = process.argv.slice(2);
const facts = JSON.parse(readFileSync(factsFile, 'utf8'));
const { browser, page } = await launch({ width: 1200, height: 900 });
const { messages, requests } = watch(page);

const text = (selector) => page.locator(selector).innerText();
const choose = (id, value) => page.locator(`#${id}`).selectOption(value);
const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Values of the moment of a run, by the heads of the columns. */
async function values(run) {
    return page.evaluate((run) => {
        const heads = [...document.querySelectorAll('#values-head th, #values-head td')].map((cell) => cell.textContent.replace(/,.*/, ''));
        const row = [...document.querySelectorAll('#values tr')].find((row) => row.cells[0].textContent === run);
        return Object.fromEntries(heads.map((head, index) => [head, Number(row.cells[index].textContent)]));
    }, run);
}

const colors = () => pixels(page);

/** Pixel of the red mark at the tip of the tool. */
const mark = () => inPicture(page, (data, width, path) => {
    let [sx, sy, count] = [0, 0, 0];
    for (let at = 0; at < data.length; at += 4) {
        if (data[at] < 200 || data[at + 1] > 90 || data[at + 2] > 70) continue;
        sx += (at / 4) % width;
        sy += Math.floor(at / 4 / width);
        count += 1;
    }
    const scale = path.clientWidth / width;
    return [(sx / count + 0.5) * scale, (sy / count + 0.5) * scale];
});

const close = (actual, wanted, tolerance, what) =>
    assert.ok(Math.abs(actual - wanted) <= tolerance, `${what}: ${actual}, not ${wanted} within ${tolerance}`);

async function opens() {
    await open(page, report);
    const times = await page.evaluate(() => Object.fromEntries(performance.getEntriesByType('mark').map(({ name, startTime }) => [name, Math.round(startTime)])));
    console.log(`after the page was asked for, ms: ${JSON.stringify(times)}`);
    assert.ok(times.data <= times.picture && times.picture <= times.complete, 'the path is seen before the rest is made');
    const drawn = await colors();
    console.log(`picture: ${drawn.drawn} pixels drawn in ${drawn.colors} colours`);
    assert.ok(drawn.drawn > 2_000 && drawn.colors > 20, 'the picture is empty');
    assert.equal(await page.locator('#curves canvas').count(), facts.curves, 'number of curves');
    // The tables of the report are below the viewer.
    for (const words of facts.tables) assert.ok((await text('main')).includes(words), words);
}

/** The values are those of the run's own figures, which come another way. */
async function agrees() {
    for (const [quantity, largest, tolerance] of facts.largest) {
        await choose('quantity', quantity);
        const shown = Number(/to (\S+)$/.exec(await page.locator('#path').getAttribute('aria-label'))[1]);
        console.log(`largest ${quantity}: ${shown} in the page, ${largest} in the figures`);
        close(shown, largest, tolerance, `largest ${quantity}`);
    }
    if (facts.feed_ratio) {
        await choose('quantity', 'ratio');
        const [, low, high] = /from (\S+) to (\S+)$/.exec(await page.locator('#path').getAttribute('aria-label'));
        console.log(`feed after over feed before: ${low} to ${high}`);
        close(Number(low), facts.feed_ratio[0], 0.01, 'least feed after over before');
        close(Number(high), facts.feed_ratio[1], 0, 'largest feed after over before');
    }
    const scrub = page.locator('#scrub');
    const [begin, end] = await scrub.evaluate((scrub) => [Number(scrub.min), Number(scrub.max)]);
    console.log(`length: ${end - begin} s in the page, ${facts.cycle_time_s} s in the figures`);
    // The axes come to rest after the last move.
    close(end - begin, facts.cycle_time_s, 0.05, 'time of the run');
}

/** Scrubber, text and path lead to the same moment. */
async function links() {
    await page.locator('#find').fill(facts.find);
    await page.locator('#search button').click();
    assert.equal(await text('#found'), `line ${facts.line}`);
    const check = async (how) => {
        const after = await values('after');
        assert.equal(after.Line, facts.line, how);
        const { center, radius, tolerance, ...place } = facts.place;
        for (const [axis, value] of Object.entries(place)) close(after[axis], value, tolerance, `${axis} ${how}`);
        if (center) close(Math.hypot(after.X - center[0], after.Y - center[1]), radius, tolerance, `radius ${how}`);
        assert.equal(await page.locator('.row.current .number').innerText(), String(facts.line), how);
        return after;
    };
    const found = await check('by the text');
    // A chip is measured as soon as a tooth has been in the cut for its whole time, a few points later.
    await page.locator('#path').focus();
    for (const [run, chip] of Object.entries(facts.chip ?? {})) {
        for (let step = 0; step < 10 && Number.isNaN((await values(run))[facts.chip_head]); step++) await page.keyboard.press('ArrowRight');
        assert.equal((await values(run)).Line, facts.line);
        close((await values(run))[facts.chip_head ?? 'Chip / target'], chip, 5e-3, `chip ${run}`);
    }
    await page.locator('#search button').click();
    // The scrubber leaves and comes back.
    const scrub = page.locator('#scrub');
    const at = await scrub.evaluate((scrub) => scrub.value);
    const set = (value) => scrub.evaluate((scrub, value) => {
        scrub.value = value;
        scrub.dispatchEvent(new Event('input'));
    }, value);
    await set(await scrub.evaluate((scrub) => scrub.max));
    assert.notEqual((await values('after')).Line, facts.line);
    await set(at);
    await check('by the scrubber');
    const marks = await page.evaluate(() => [...document.querySelectorAll('.moment.after')].map((mark) => mark.style.transform));
    assert.ok(marks.length === facts.curves && marks.every((mark) => mark === marks[0]), `${marks}`);
    // The curves at the place of their own mark.
    await set(await scrub.evaluate((scrub) => scrub.min));
    const left = Number(/translateX\((.*)px\)/.exec(marks[0])[1]);
    const over = page.locator('#curves .u-over').first();
    await over.hover({ position: { x: left, y: 30 } });
    close((await values('after'))['Time'], found['Time'], facts.pixel_s, 'time by the curve');
    // The picture at the place of the tool, seen from above: the mark is where the tool is.
    await set(at);
    await page.locator('[data-view=XY]').click();
    await settle();
    const tip = await mark();
    await set(await scrub.evaluate((scrub) => scrub.min));
    await page.locator('#path').hover({ position: { x: tip[0], y: tip[1] } });
    await settle();
    const pointed = await values('after');
    console.log(`pointed at the tool: line ${pointed.Line}, X ${pointed.X} Y ${pointed.Y}`);
    for (const axis of ['X', 'Y']) close(pointed[axis], found[axis], facts.pixel, `${axis} by the picture`);
}

async function switches() {
    await page.locator('[data-show=after]').click();
    const after = await colors();
    await page.locator('[data-show=before]').click();
    const before = await colors();
    // A program that no rule changes has the same path before and after.
    if (facts.chip) assert.notDeepEqual(after.counts, before.counts, 'before and after look alike');
    await page.locator('[data-show=both]').click();
    assert.equal(await text('#names'), 'before\nafter');
    await page.locator('[data-show=after]').click();
    for (const view of ['XY', 'XZ', 'YZ', 'iso']) {
        await page.locator(`[data-view=${view}]`).click();
        assert.ok((await colors()).drawn > 500, view);
    }
    const stock = page.locator('#stock');
    if (await stock.isVisible()) {
        const full = await colors();
        await stock.uncheck();
        assert.notDeepEqual((await colors()).counts, full.counts, 'the stock stays');
    }
    const light = await colors();
    await page.locator('#theme').click();
    const dark = await colors();
    const most = ({ counts }) => Object.entries(counts).sort((a, b) => b[1] - a[1])[0][0].split(',').map(Number);
    assert.ok(most(light)[0] > 12 && most(dark)[0] < 4, `${most(light)} and ${most(dark)}`);
    await choose('along', 'path');
    await choose('along', 'time');
}

/** A click holds the moment, and Escape lets it go; nothing that is pointed at moves it in between, nor while Measure is on. */
async function holds() {
    const over = page.locator('#curves .u-over').first();
    const { width } = await over.boundingBox();
    const time = async () => (await values('after')).Time;
    const point = (part) => over.hover({ position: { x: part * width, y: 30 } });
    await point(0.3);
    const first = await time();
    await over.click({ position: { x: 0.5 * width, y: 30 } });
    const held = await time();
    assert.notEqual(held, first);
    await point(0.7);
    assert.equal(await time(), held);
    assert.ok(await page.locator('#held').isVisible());
    await page.locator('#path').focus();
    await page.keyboard.press('Escape');
    await point(0.6);
    assert.notEqual(await time(), held);
    const free = await time();
    await page.locator('#measure').click();
    await point(0.4);
    assert.equal(await time(), free);
    await page.locator('#path').focus();
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#measured').isHidden());
}

/** The mark stands at its moment after a zoom, before the pointer moves. */
async function zooms() {
    const over = page.locator('#curves .u-over').first();
    const { x, y, width } = await over.boundingBox();
    await page.locator('#scrub').evaluate((scrub) => scrub.dispatchEvent(new Event('input')));
    const left = () => page.evaluate(() => Number(/translateX\((.*)px\)/.exec(document.querySelector('.moment.after').style.transform)[1]));
    await over.hover({ position: { x: 0.5 * width, y: 30 } });
    await page.mouse.move(x + 0.3 * width, y + 30);
    await page.mouse.down();
    await page.mouse.move(x + 0.6 * width, y + 30);
    await page.mouse.up();
    await settle();
    // The pointer was last at 0.3 before the press: the left edge of the range.
    close(await left(), 0, 3, 'mark after the zoom');
    await over.dblclick({ position: { x: 0.5 * width, y: 30 } });
    await settle();
}

/** Moves the slider to a part of the run. */
async function moment(part) {
    await page.locator('#scrub').evaluate((scrub, part) => {
        scrub.value = String(Number(scrub.min) + (Number(scrub.max) - Number(scrub.min)) * part);
        scrub.dispatchEvent(new Event('input'));
    }, part);
    await settle();
}

/** Distance, dX, dY, dZ that the page shows. */
async function measured() {
    const shown = /^Distance (\S+) \S+: dX (\S+), dY (\S+), dZ (\S+); from .* to /.exec(await text('#measured'));
    assert.ok(shown, await text('#measured'));
    return shown.slice(1).map(Number);
}

/** Two moments by the keyboard, whose places are in the table; then two places on the stock by the pointer, seen from above. */
async function measures() {
    const tip = async (part) => {
        await moment(part);
        await page.locator('#path').focus();
        await page.keyboard.press('Enter');
        const { X, Y, Z } = await values('after');
        return [X, Y, Z];
    };
    await page.locator('#path').focus();
    await page.keyboard.press('m');
    const [from, to] = [await tip(0.3), await tip(0.7)];
    const way = to.map((value, axis) => value - from[axis]);
    const [distance, ...shown] = await measured();
    for (const axis of [0, 1, 2]) close(shown[axis], way[axis], 2e-3, `d${'XYZ'[axis]} by the keyboard`);
    close(distance, Math.hypot(...way), 2e-3, 'distance by the keyboard');
    if (facts.stock) {
        await page.locator('#stock').check();
        // Parallel rays: all that is drawn has the same scale. Before the first cut the top is even.
        await page.locator('[data-view=XY]').click();
        await moment(0);
        for (const at of facts.stock.at) await page.locator('#path').click({ position: await pixelAt(at) });
        const [, dx, dy, dz] = await measured();
        const [[x1, y1], [x2, y2]] = facts.stock.at;
        const width = (await page.locator('#path').boundingBox()).width;
        assert.ok(Math.abs(dz) <= 1e-3, `dZ on the stock's top: ${dz}`);
        const perPixel = Math.abs(dx) / Math.abs((x2 - x1) * width);
        close(perPixel, await scaleAt(), 0.02 * perPixel, 'length of a pixel on the stock and on the path');
        assert.ok(dx > 0 === x2 > x1 && dy < 0 === y2 > y1, 'X to the right, Y up');
        console.log(`on the stock: ${dx} ${dy} ${dz}, ${perPixel} a pixel`);
    }
    await page.keyboard.press('m');
    assert.ok(await page.locator('#measured').isHidden());
}

const pixelAt = async ([x, y]) => {
    const { width, height } = await page.locator('#path').boundingBox();
    return { x: x * width, y: y * height };
};

/** Length that a pixel has, by the mark of the tool at two moments. */
async function scaleAt() {
    const ends = [];
    for (const part of facts.stock.moments) {
        await moment(part);
        ends.push([(await values('after')).X, (await mark())[0]]);
    }
    return Math.abs((ends[1][0] - ends[0][0]) / (ends[1][1] - ends[0][1]));
}

/** Each finding leads to its block. */
async function findings() {
    const buttons = page.locator('#findings button');
    const count = await buttons.count();
    console.log(`${count} findings`);
    assert.equal(count, facts.findings);
    for (let index = 0; index < Math.min(count, 5); index++) {
        await buttons.nth(index).click();
        const n = /N(\d+)/.exec(await buttons.nth(index).innerText())?.[1];
        if (n) assert.ok((await text('.row.current')).includes(`N${n}`), `finding at N${n}`);
    }
}

/** Keys work wherever the viewer was clicked last. */
async function keys() {
    await page.locator('#curves figcaption').first().click();
    const time = (await values('after')).Time;
    await page.keyboard.press('Shift+ArrowRight');
    assert.notEqual((await values('after')).Time, time);
    await page.keyboard.press('b');
    assert.equal(await page.locator('[data-show=before]').getAttribute('aria-pressed'), 'true');
    await page.keyboard.press('a');
    await page.keyboard.press('d');
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'light');
}

async function inBothThemes() {
    for (const theme of ['light', 'dark']) {
        await accessible(page, theme);
        await page.locator('#theme').click();
    }
}

try {
    for (const step of [opens, agrees, links, holds, zooms, switches, measures, findings, keys, inBothThemes]) {
        await step();
        console.log(`${step.name}: passed`);
    }
    if (screenshot) await page.screenshot({ path: screenshot, fullPage: true });
    assert.deepEqual(messages, [], 'messages on the console');
    const elsewhere = requests.filter((url) => !url.startsWith('file:') && !url.startsWith('data:') && !url.startsWith('blob:'));
    assert.deepEqual([elsewhere, requests.filter((url) => url.startsWith('file:')).length], [[], 1], 'requests');
} finally {
    await browser.close();
}
