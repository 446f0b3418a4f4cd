// The live page of a running sender in real browsers: `node test/live.mjs URL [PICTURE.png]`. It holds, resumes and aborts.
import assert from 'node:assert/strict';
import { accessible, launch, pixels, watch } from './browser.mjs';

const [url, picture] = process.argv.slice(2);
const { browser, page } = await launch({ width: 1200, height: 1100 });
const pages = [page, await browser.newPage(), await browser.newPage()];
const watched = pages.map(watch);

const state = (page) => page.locator('#live-state').innerText();
const figure = (page, name) => page.locator('#live-figures div', { has: page.locator('dt', { hasText: new RegExp(`^${name}$`) }) }).locator('dd').innerText();
const until = (page, words) => page.waitForFunction((words) => document.getElementById('live-state').textContent.includes(words), words);

/** All pages show the machine, and move with it. */
async function follows() {
    for (const page of pages) {
        page.setDefaultTimeout(90_000);
        await page.goto(url);
        await page.waitForFunction(() => document.documentElement.dataset.viewer === 'ready');
        await page.waitForFunction(() => document.querySelector('.row.current') && !document.getElementById('hold').disabled);
    }
    const { drawn, colors } = await pixels(page);
    console.log(`picture: ${drawn} pixels drawn in ${colors} colours`);
    assert.ok(drawn > 2_000 && colors > 10, 'the picture is empty');
    const places = async () => Promise.all(['X', 'Y', 'Z'].map((axis) => figure(page, axis)));
    const before = await places();
    assert.ok(before.every((place) => /^-?\d+\.\d+ (mm|in)$/.test(place)), `${before}`);
    await page.waitForFunction((before) => {
        const shown = [...document.querySelectorAll('#live-figures dd')].slice(0, 3).map((cell) => cell.textContent);
        return shown.join() !== before.join();
    }, before);
    for (const name of ['Feed', 'Override', 'Elapsed', 'At the control']) assert.notEqual(await figure(page, name), 'unknown', name);
    // The marked line of the listing is the line that is executed.
    const [line, marked] = await page.evaluate(() => [
        document.getElementById('live-line').textContent, document.querySelector('.row.current .number')?.textContent,
    ]);
    assert.equal(line, `executes line ${marked}`);
}

/** Pictures that a page draws in a second. */
const picturesInASecond = (page) => page.evaluate(async () => {
    const ask = globalThis.requestAnimationFrame;
    let count = 0;
    globalThis.requestAnimationFrame = (draw) => {
        count += 1;
        return ask(draw);
    };
    await new Promise((done) => setTimeout(done, 1000));
    globalThis.requestAnimationFrame = ask;
    return count;
});

/** A hold is seen by all; pictures are drawn while the axes move, none while they stand. */
async function holds() {
    let [moving, standing] = [0, Infinity];
    for (let second = 0; second < 30 && moving === 0; second++) moving = await picturesInASecond(page);
    await page.locator('#hold').click();
    for (const page of pages) await until(page, 'HELD: sending stopped, the axes NOT');
    for (let second = 0; second < 30 && standing > 0; second++) standing = await picturesInASecond(page);
    console.log(`${moving} pictures in a second while the axes move, ${standing} while they stand`);
    assert.ok(moving > 0 && standing === 0, `${moving} ${standing}`);
}

/** Only a confirmed resume ends the hold. */
async function resumes() {
    const other = pages[1];
    await other.locator('#resume').click();
    await other.locator('#no').click();
    assert.ok((await state(page)).includes('HELD'));
    await other.locator('#resume').click();
    await other.locator('#yes').click();
    for (const page of pages) await page.waitForFunction(() => !document.getElementById('live-state').textContent.includes('HELD'));
}

async function themes() {
    for (const theme of ['light', 'dark']) {
        if (picture && theme === 'light') await page.screenshot({ path: picture });
        await accessible(page, theme);
        await page.locator('#theme').click();
    }
}

async function ends() {
    await page.locator('#abort').click();
    await page.locator('#yes').click();
    for (const page of pages) {
        await until(page, 'ended: aborted');
        assert.ok(await page.locator('#abort').isDisabled());
    }
}

try {
    for (const step of [follows, holds, resumes, themes, ends]) {
        await step();
        console.log(`${step.name}: passed`);
    }
    for (const { messages, requests } of watched) {
        assert.deepEqual(messages, [], 'messages on the console');
        assert.deepEqual(requests.filter((request) => !request.startsWith(url) && !/^(data|blob):/.test(request)), [], 'requests elsewhere');
    }
} finally {
    await browser.close();
}
