// From a program to an adapted one in the page of `arcfeed view`: `node test/view.mjs URL PROGRAM.nc FACTS.json FOLDER`. Downloads go into
// the folder.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { accessible, launch, watch } from './browser.mjs';

const [url, program, factsFile, folder] = process.argv.slice(2);
const facts = JSON.parse(readFileSync(factsFile, 'utf8'));
const { browser, page } = await launch({ width: 1200, height: 1000 });
const { messages, requests } = watch(page);
const ready = () => page.waitForFunction(() => document.documentElement.dataset.state === 'ready');
const text = (selector) => page.locator(selector).innerText();
/** Clicks, and waits for the answer. */
const act = async (selector) => {
    await page.evaluate(() => (document.documentElement.dataset.state = 'asked'));
    await page.locator(selector).click();
    await ready();
};
/** Runs the job with a click, and waits until the page has loaded its report: the next run or program takes it away. */
const actAndLoad = async (selector) => {
    const loaded = page.waitForResponse((response) => response.url().startsWith(`${url}report?`));
    await act(selector);
    await loaded;
};

/** The program is dropped onto the zone, as a file from the desktop is. */
async function drops() {
    await page.goto(url);
    await ready();
    assert.ok(await page.locator('#job-part').isHidden());
    const transfer = await page.evaluateHandle(([name, text]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([text], name));
        return transfer;
    }, [basename(program), readFileSync(program, 'latin1')]);
    await page.evaluate(() => (document.documentElement.dataset.state = 'asked'));
    await page.locator('#drop').dispatchEvent('drop', { dataTransfer: transfer });
    await ready();
    assert.equal(await text('#program'), basename(program));
}

/** Words at a field of the form. */
const hint = (name) => text(`#hint-${name}`);

/** What cannot be used is refused at its field, in the words of a form, and nothing runs; what is missing is asked for there. */
async function forms() {
    assert.match(await text('#found'), facts.found ? new RegExp(facts.found) : /./);
    for (const [name, value] of Object.entries(facts.wrong)) {
        await page.locator(`#values [name=${name}]`).fill(value);
        await act('#run');
        assert.match(await hint(name), new RegExp(`^${value.replace('.', '\\.')} cannot be used`));
        assert.doesNotMatch(await hint(name), /--|help|digit/);
        assert.equal(await page.evaluate(() => document.activeElement.name), name);
        assert.ok(await page.locator('#report-part').isHidden());
        await page.locator(`#values [name=${name}]`).fill('');
    }
    for (const [name, value] of Object.entries(facts.form)) {
        const field = page.locator(`#values [name=${name}]`);
        if (await field.evaluate((field) => field.tagName === 'SELECT')) await field.selectOption(value);
        else await field.fill(value);
    }
    // Each question has one field: that of the form, if there is one.
    const asked = [];
    while (asked.length < Object.keys(facts.answers).length) {
        await act('#run');
        const name = await page.evaluate(() => document.activeElement.name);
        assert.ok(facts.answers[name] && !asked.includes(name), `${name} after ${asked}`);
        assert.ok(await page.locator('#report-part').isHidden());
        await page.locator(`#values [name=${name}]`).fill(facts.answers[name]);
        asked.push(name);
    }
}

/** The button takes the form as it stands. */
async function shows() {
    await act('#run');
    const job = await page.locator('#job').inputValue();
    for (const words of facts.job) assert.ok(job.includes(words), `${words}\n${job}`);
    assert.ok(await page.locator('#report-title').evaluate((title) => title.getBoundingClientRect().top < innerHeight), 'the result is in view');
    assert.ok(await page.locator('#report-part').isVisible(), await page.locator('#messages').textContent());
    const report = page.frameLocator('#report');
    await report.locator('html[data-viewer=ready]').waitFor({ timeout: 60_000 });
    assert.ok((await report.locator('#show button').allInnerTexts()).includes('Side by side'));
    await report.locator('[data-show=both]').click();
    assert.equal(await report.locator('#names').innerText(), 'before\nafter');
}

async function downloads() {
    for (const [name, file] of [['adapted', facts.adapted], ['job', facts.job_file]]) {
        const [download] = await Promise.all([page.waitForEvent('download'), page.locator(`a[href=${name}]`).click()]);
        assert.equal(download.suggestedFilename(), file);
        await download.saveAs(join(folder, file));
    }
}

/** Results of another job are marked; changes of the job by hand are not lost unasked. */
async function keeps() {
    await page.locator('#job-details').evaluate((details) => (details.open = true));
    const job = page.locator('#job');
    const own = `# By hand.\n${await job.inputValue()}`;
    assert.ok(await page.locator('#stale').isHidden());
    await job.fill(own);
    assert.ok(await page.locator('#stale').isVisible());
    await page.locator('#values [name=teeth]').fill('5');
    await page.locator('#run').click();
    await page.locator('#conflict [value=""]').click();
    assert.equal(await job.inputValue(), own);
    await page.locator('#run').click();
    await actAndLoad('#conflict [value=text]');
    assert.equal(await job.inputValue(), own);
    assert.ok(await page.locator('#report-part').isVisible() && await page.locator('#stale').isHidden());
    await page.locator('#values [name=teeth]').fill('6');
    await page.locator('#run').click();
    await actAndLoad('#conflict [value=form]');
    assert.match(await job.inputValue(), /^teeth = 6$/m);
}

/** Files that are no program, and a program without a unit. */
async function others() {
    const take = async (name, text) => {
        await page.evaluate(() => (document.documentElement.dataset.state = 'asked'));
        await page.locator('#file').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
        await ready();
    };
    for (const [name, content, words] of [['empty.nc', '', 'is empty'], ['list.txt', 'two apples\nbread\n', 'no NC program']]) {
        await take(name, content);
        assert.ok((await text('#messages')).includes(words), await text('#messages'));
        assert.ok(await page.locator('#job-part').isHidden());
    }
    await take('bare.nc', 'G17G90G94\nT3M6(T3 D=10)\nS3000M3\nG0X0Y0Z5\nG1Z-2F300\nX10F600\nG3I-10\nG0Z5\nT5M6(T5 D=8)\nG0X0Y0Z5\nG1Z-2F300\nX10F600\nG3I-10\nG0Z5\nM30\n');
    assert.deepEqual(await page.locator('#tools legend').allInnerTexts(), ['T3', 'T5']);
    assert.equal(await page.locator('#values [name="tool.5"]').getAttribute('placeholder').then((words) => parseFloat(words)), 8);
    assert.equal(await page.locator('#questions select[name=units] option').count(), 3);
    await page.locator('#values [name="tool.3"]').fill('500');
    await page.locator('#questions [name=units]').selectOption('mm');
    await act('#run');
    assert.equal(await page.locator('#questions [name=units]').inputValue(), 'mm');
    const job = await page.locator('#job').inputValue();
    assert.match(await text('#messages'), /^warning: T3: diameter 500\S* \w+, but .*: check it$/m, 'a contradiction, beside the result too');
    assert.ok(/diameter = 500/.test(job) && /diameter = 8/.test(job) && /units = "mm"/.test(job), job);
}

/** A job that names files of the computer is refused, and the old report does not stay beside it. */
async function refuses() {
    await page.locator('#job-details').evaluate((details) => (details.open = true));
    const job = page.locator('#job');
    await job.fill((await job.inputValue()).replace(/program = .*/, 'program = "/dev/null"'));
    await act('#run');
    assert.ok((await text('#messages')).includes('a file outside of this page'), await text('#messages'));
    assert.ok(await page.locator('#report-part').isHidden());
}

async function themes() {
    for (const scheme of ['light', 'dark']) {
        await page.emulateMedia({ colorScheme: scheme });
        await page.goto(url);
        await ready();
        const ground = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
        assert.equal(ground, scheme === 'dark' ? 'rgb(20, 23, 28)' : 'rgb(255, 255, 255)');
        await accessible(page, scheme);
        await page.screenshot({ path: join(folder, `${scheme}.png`), fullPage: true });
    }
}

try {
    for (const step of [drops, forms, shows, downloads, keeps, refuses, others, themes]) {
        await step();
        console.log(`${step.name}: passed`);
    }
    assert.deepEqual(messages, [], 'messages on the console');
    assert.deepEqual(requests.filter((request) => !request.startsWith(url) && !/^(data|blob|about):/.test(request)), [], 'requests elsewhere');
} finally {
    await browser.close();
}
