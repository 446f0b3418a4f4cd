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

/** The form changes the proposal; open questions become fields. */
async function forms() {
    for (const [name, value] of Object.entries(facts.form)) {
        const field = page.locator(`#values [name=${name}]`);
        if (await field.evaluate((field) => field.tagName === 'SELECT')) await field.selectOption(value);
        else await field.fill(value);
    }
    await act('#values button');
    const job = await page.locator('#job').inputValue();
    for (const words of facts.job) assert.ok(job.includes(words), `${words}\n${job}`);
    const questions = await page.locator('#questions input').evaluateAll((inputs) => inputs.map((input) => input.name));
    assert.deepEqual(questions, Object.keys(facts.answers));
    // What is open is refused in the words of the terminal.
    if (questions.length > 0) {
        await act('#run');
        assert.ok((await text('#messages')).includes('an open question'), await text('#messages'));
    }
    for (const [name, value] of Object.entries(facts.answers)) await page.locator(`#questions [name="${name}"]`).fill(value);
}

async function shows() {
    await act('#run');
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

/** A job that names files of the computer is refused, and the old report does not stay beside it. */
async function refuses() {
    await page.locator('#job-details').evaluate((details) => (details.open = true));
    const job = page.locator('#job');
    await job.fill((await job.inputValue()).replace(/program = .*/, 'program = "/dev/null"'));
    await act('#run');
    assert.ok((await text('#messages')).includes('a file outside of this page'), await text('#messages'));
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
    for (const step of [drops, forms, shows, downloads, themes, refuses]) {
        await step();
        console.log(`${step.name}: passed`);
    }
    assert.deepEqual(messages, [], 'messages on the console');
    assert.deepEqual(requests.filter((request) => !request.startsWith(url) && !/^(data|blob|about):/.test(request)), [], 'requests elsewhere');
} finally {
    await browser.close();
}
