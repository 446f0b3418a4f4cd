// A program adapted by arcfeed inside the page: `node test/inpage.mjs PAGE.html PROGRAM.nc JOB.toml FOLDER`. The adapted program and the
// report go into the folder.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { accessible, launch, watch } from './browser.mjs';

const [file, program, jobFile, folder] = process.argv.slice(2);
const { browser, page } = await launch({ width: 1200, height: 1000 });
page.setDefaultTimeout(120_000);
const { messages, requests } = watch(page);
const ready = () => page.waitForFunction(() => document.documentElement.dataset.state === 'ready');
const act = async (selector) => {
    await page.evaluate(() => (document.documentElement.dataset.state = 'asked'));
    await page.locator(selector).click();
    await ready();
};
const text = (selector) => page.locator(selector).innerText();
const take = async (path, content) => {
    await page.evaluate(() => (document.documentElement.dataset.state = 'asked'));
    await page.locator('#file').setInputFiles({ name: basename(path), mimeType: 'text/plain', buffer: content ?? readFileSync(path) });
    await ready();
};

async function opens() {
    const began = Date.now();
    await page.goto(pathToFileURL(file).href);
    await ready();
    assert.match(await text('#where'), /inside this page/);
    console.log(`page ready after ${((Date.now() - began) / 1000).toFixed(2)} s`);
}

/** The job of the program beside it is put in the place of the proposed one. */
async function adapts() {
    await take(program);
    assert.equal(await text('#program'), basename(program));
    await page.locator('#job-details').evaluate((details) => (details.open = true));
    assert.ok((await page.locator('#job').inputValue()).includes(`program = "${basename(program)}"`));
    await page.locator('#job').fill(readFileSync(jobFile, 'utf8'));
    const began = Date.now();
    await act('#run');
    console.log(`adapted and simulated in ${((Date.now() - began) / 1000).toFixed(2)} s`);
    assert.ok(await page.locator('#report-part').isVisible(), await text('#messages'));
    const report = page.frameLocator('#report');
    await report.locator('html[data-viewer=ready]').waitFor();
    await report.locator('[data-show=both]').click();
    assert.equal(await report.locator('#names').innerText(), 'before\nafter');
    await page.screenshot({ path: join(folder, 'page.png'), fullPage: true });
}

async function downloads() {
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('a[href=adapted]').click()]);
    await download.saveAs(join(folder, 'adapted.nc'));
    const frame = page.frames().find((frame) => frame.url().startsWith('blob:'));
    writeFileSync(join(folder, 'data.txt'), await frame.evaluate(() => document.getElementById('arcfeed-data').textContent));
}

/** The example of the page, with one click. */
async function shows() {
    // A person, too, scrolls up first: the result is in view.
    await page.evaluate(() => scrollTo(0, 0));
    await page.locator('#example').click();
    await page.waitForFunction(() => document.getElementById('program').textContent === 'pocket.nc'
        && !document.getElementById('report-part').hidden && document.getElementById('report').hasAttribute('src'));
    const report = page.frameLocator('#report');
    await report.locator('h1', { hasText: 'pocket.nc' }).waitFor();
    await report.locator('html[data-viewer=ready]').waitFor();
    await page.screenshot({ path: join(folder, 'example.png'), fullPage: true });
}

/** A fault of the program is said in the words of the terminal; a run that does not end is stopped, and the page works on. */
async function refuses() {
    await page.locator('#job').fill('units = "mm"\n');
    await act('#run');
    assert.match(await text('#messages'), /\.toml:\d+:\d+/);
    assert.ok(await page.locator('#report-part').isHidden());
    const endless = '%\nO1\nG21G17G90G94\nS3000M3\nN1G0X0.Y0.Z5.\n' + 'N2G4X9000.\n'.repeat(9) + 'N3G1X10.F60.\nM30\n%\n';
    await take('endless.nc', Buffer.from(endless));
    await page.locator('#job').fill(readFileSync(jobFile, 'utf8').replace(/program = .*/, 'program = "endless.nc"'));
    await page.locator('#run').click();
    await page.waitForFunction(() => document.documentElement.dataset.state === 'busy');
    await page.locator('#stop').click();
    await page.waitForFunction(() => document.documentElement.dataset.state === 'failed');
    assert.equal(await text('#state'), 'stopped');
    await take(program);
    assert.equal(await text('#program'), basename(program));
}

try {
    for (const step of [opens, adapts, downloads, shows, refuses]) {
        await step();
        console.log(`${step.name}: passed`);
    }
    await accessible(page, 'page');
    assert.deepEqual(messages, [], 'messages on the console');
    const elsewhere = requests.filter((url) => !/^(data|blob|about):/.test(url));
    assert.deepEqual(elsewhere, [pathToFileURL(file).href], 'requests');
} finally {
    await browser.close();
}
