// SPDX-License-Identifier: GPL-3.0-or-later
// usage: node report.test.mjs REPORT.html [made-up]
// Opens a report as a user would and fails (exit 1) at the first thing that is not as it should be. With "made-up" the
// report is report_sample's, whose texts try to break out and whose every section must be there.
import assert from 'node:assert/strict';
import { openReport } from './browser.mjs';

const [report, kind] = process.argv.slice(2);
if (!report) throw new Error('usage: node report.test.mjs REPORT.html [made-up]');
const madeUp = kind === 'made-up';

/// Shares of the canvas' pixels by kind, from a screenshot (what the user sees, not what a buffer holds).
async function canvasPixels(page) {
  const png = (await page.locator('#viewer canvas').screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = document.createElement('canvas');
    canvas.width = image.width;
    canvas.height = image.height;
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const { data: rgba } = context.getImageData(0, 0, image.width, image.height);
    let hash = 0;
    const colours = new Set();
    for (let i = 0; i < rgba.length; i += 4) {
      const colour = (rgba[i] << 16) | (rgba[i + 1] << 8) | rgba[i + 2];
      colours.add(colour);
      hash = (Math.imul(hash, 31) + colour) | 0;
    }
    return { colours: colours.size, hash };
  }, png);
}

/// Until the picture is at rest: all of it drawn.
const settle = (page) => page.evaluate(() => new Promise((done) => {
  const wait = () => {
    if (document.getElementById('viewer').dataset.moving === 'yes') setTimeout(wait, 50);
    else requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 60)));
  };
  setTimeout(wait, 20);
}));

const checks = {
  async 'the three-dimensional view starts and is not blank'({ page }) {
    assert.equal(await page.locator('#viewer').getAttribute('data-state'), 'ready');
    assert.ok((await canvasPixels(page)).colours > 200, 'the picture has hardly any colours');
  },

  async 'every layer can be taken away and brought back'({ page }) {
    const boxes = page.locator('#layers input[type=checkbox][id^="layer-"]');
    const count = await boxes.count();
    assert.ok(count >= (madeUp ? 5 : 2), `only ${count} layers`);
    const whole = await canvasPixels(page);
    for (let k = 0; k < count; ++k) {
      const box = boxes.nth(k);
      const name = await box.getAttribute('id');
      await box.uncheck();
      await settle(page);
      const without = await canvasPixels(page);
      assert.notEqual(without.hash, whole.hash, `${name}: taking it away changes nothing`);
      await box.check();
      await settle(page);
      assert.equal((await canvasPixels(page)).hash, whole.hash, `${name}: not the same after bringing it back`);
    }
  },

  async 'colours change with what they stand for'({ page }) {
    const seen = new Set();
    for (const mode of await page.locator('#colour option').evaluateAll((all) => all.map((o) => o.value))) {
      await page.selectOption('#colour', mode);
      await settle(page);
      seen.add((await canvasPixels(page)).hash);
      assert.ok((await page.locator('#colour-key').innerText()).trim().length > 0, `${mode}: no legend`);
    }
    assert.ok(seen.size >= 4, `${seen.size} different pictures`);
    await page.selectOption('#colour', 'order');
  },

  async 'a clicked cylinder tells its radius, order and quality'({ page }) {
    await page.locator('#viewer canvas').scrollIntoViewIfNeeded();
    const frame = await page.locator('#viewer canvas').boundingBox();
    let words = '';
    // Rows of clicks across the lower third of the trees, until one meets wood.
    for (let row = 0.45; row < 0.95 && !words; row += 0.05)
      for (let column = 0.02; column < 1 && !words; column += 0.008) {
        await page.mouse.click(frame.x + column * frame.width, frame.y + row * frame.height);
        if (await page.locator('#reading').isVisible()) words = await page.locator('#reading').innerText();
      }
    assert.match(words, /cylinder \d+: radius \d+\.\d+( ± \d+\.\d+)? cm, order \d+, (measured|interpolated|allometric|extrapolated)/);
    if (madeUp) assert.match(words, / ± /);
    await page.mouse.click(frame.x + 3, frame.y + 3);
    assert.ok(!(await page.locator('#reading').isVisible()), 'a click on nothing leaves the reading');
  },

  async 'turning and zooming move the picture'({ page }) {
    const frame = await page.locator('#viewer canvas').boundingBox();
    const before = await canvasPixels(page);
    await page.mouse.move(frame.x + 0.5 * frame.width, frame.y + 0.5 * frame.height);
    await page.mouse.down();
    await page.mouse.move(frame.x + 0.7 * frame.width, frame.y + 0.45 * frame.height, { steps: 4 });
    await page.mouse.up();
    await settle(page);
    assert.equal(await page.locator('#viewer').getAttribute('data-detail'), '1', 'at rest all of it is drawn');
    const turned = await canvasPixels(page);
    assert.notEqual(turned.hash, before.hash, 'turning');
    await page.mouse.wheel(0, -400);
    await settle(page);
    assert.notEqual((await canvasPixels(page)).hash, turned.hash, 'zooming');
    await page.click('#look-whole');
    await settle(page);
    assert.equal((await canvasPixels(page)).hash, before.hash, 'back to the whole');
  },

  async 'by keyboard: arrows turn, Page Down reads the next cylinder, Escape ends it, Home shows all'({ page }) {
    const canvas = page.locator('#viewer canvas');
    await page.click('#look-whole');
    await settle(page);
    const before = await canvasPixels(page);
    await canvas.focus();
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('+');
    await settle(page);
    assert.notEqual((await canvasPixels(page)).hash, before.hash, 'turning');
    await page.keyboard.press('PageDown');
    const first = await page.locator('#reading').innerText();
    assert.match(first, /cylinder \d+: radius \d+\.\d+.* cm, order \d+, (measured|interpolated|allometric|extrapolated)/);
    await page.keyboard.press('PageDown');
    assert.notEqual(await page.locator('#reading').innerText(), first);
    await page.keyboard.press('PageUp');
    assert.equal(await page.locator('#reading').innerText(), first);
    await page.keyboard.press('Escape');
    assert.ok(!(await page.locator('#reading').isVisible()), 'Escape leaves the reading');
    await page.keyboard.press('Home');
    await canvas.blur();  // the focus' outline is no part of the picture
    await settle(page);
    assert.equal((await canvasPixels(page)).hash, before.hash, 'Home');
  },

  async 'a frame takes few draw calls, and less is drawn while turning'({ page }) {
    const cost = () => page.locator('#viewer').getAttribute('data-cost').then(JSON.parse);
    await settle(page);
    const rest = await cost();
    assert.ok(rest.calls <= 12, `${rest.calls} draw calls`);
    await page.locator('#viewer canvas').focus();
    for (let k = 0; k < 12; ++k) {
      await page.keyboard.press('ArrowRight');
      await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    }
    const moving = await cost();
    console.log(`     at rest ${rest.calls} calls, ${rest.triangles} triangles, ${rest.points} points; turning ${moving.calls} calls, `
      + `${moving.triangles} triangles, ${moving.points} points in ${moving.ms} ms`);
    assert.ok(moving.triangles <= rest.triangles && moving.points <= rest.points);
    await page.click('#look-whole');
    await settle(page);
    assert.deepEqual({ ...(await cost()), ms: 0 }, { ...rest, ms: 0 }, 'at rest again, all of it');
  },

  async 'the first screen tells height, diameter, volumes and their intervals'({ page }) {
    const facts = await page.locator('#facts').innerText();
    for (const word of ['Height', 'Diameter at breast height', 'Stem volume', 'Branch volume', 'Total wood volume'])
      assert.ok(facts.includes(word), word);
    const box = await page.locator('#facts').boundingBox();
    assert.ok(box.y + box.height < 900, 'the facts end below the first screen');
  },

  async 'the growth slider takes the tree back to its first cycles'({ page }) {
    const slider = page.locator('#cycle');
    if (!madeUp && !(await slider.count())) return 'no birth cycles in this report';
    const words = () => page.locator('#growth-reading').innerText();
    const last = await words();
    await slider.focus();
    await settle(page);
    const full = await canvasPixels(page);
    await page.keyboard.press('Home');
    await settle(page);
    const first = await words();
    assert.match(first, /^cycle \d+ of \d+: [\d,]+ internodes, \d+\.\d\d m high$/);
    const internodes = (text) => Number(text.match(/: ([\d,]+) internodes/)[1].replaceAll(',', ''));
    assert.ok(internodes(first) < internodes(last), `${first} / ${last}`);
    assert.notEqual((await canvasPixels(page)).hash, full.hash);
    await page.keyboard.press('End');
    await settle(page);
    assert.equal(await words(), last);
    assert.equal((await canvasPixels(page)).hash, full.hash);
  },

  async 'tables and plots are there and hold numbers'({ page }) {
    const wanted = ['#table-metrics', '#plot-taper', '#plot-volume-order', '#plot-volume-diameter', '#plot-branch-angle',
      '#plot-branch-length', '#plot-profile', '#table-provenance', '#side-by-side'];
    if (madeUp || (await page.locator('#table-parameters').count()))
      wanted.push('#table-parameters', '#table-descriptors', '#table-stages', '#plot-growth-1', '#plot-parameters', '#plot-cost', '#table-leaves');
    for (const id of wanted) assert.equal(await page.locator(id).count(), 1, id);
    const drawn = await page.locator('figure.plot > svg').evaluateAll((all) => all.map((svg) => [
      svg.closest('figure').id, svg.querySelectorAll('path[d^="M"], circle, g rect').length, /NaN|inf/.test(svg.outerHTML)]));
    for (const [id, marks, broken] of drawn) assert.ok(marks > 0 && !broken, `${id}: ${marks} marks${broken ? ', broken numbers' : ''}`);
    const picture = await page.locator('#side-by-side').evaluate((img) => [img.complete, img.naturalWidth]);
    assert.ok(picture[0] && picture[1] > 300, 'side-by-side picture');
  },

  async 'odd names stay text'({ page }) {
    if (!madeUp) return 'needs the made-up report';
    assert.match(await page.title(), /<script>document\.title='broken'<\/script>/);
    assert.match(await page.locator('h1').innerText(), /Bäume "<b>no\. 7<\/b>" & 'Sons'/);
    assert.equal(await page.locator('h1 b, img[src="x"]').count(), 0);
  },

  async 'nothing sticks out at 1280 and 390 pixels'({ page }) {
    for (const width of [1280, 390]) {
      await page.setViewportSize({ width, height: 900 });
      await settle(page);
      const over = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(over <= 0, `${width}: ${over} pixels too wide`);
      const small = await page.evaluate(() => [...document.querySelectorAll('.plot text')]
        .map((t) => t.getBoundingClientRect().height).filter((h) => h > 0 && h < 9).length);
      assert.equal(small, 0, `${width}: ${small} labels under 9 pixels`);
    }
    await page.setViewportSize({ width: 1280, height: 900 });
  },

  async 'a view that was not touched fits its frame again after the frame changes'({ page }) {
    await page.click('#look-whole');
    await settle(page);
    const before = await canvasPixels(page);
    await page.setViewportSize({ width: 600, height: 1400 });
    await settle(page);
    await page.setViewportSize({ width: 1280, height: 900 });
    await settle(page);
    assert.equal((await canvasPixels(page)).hash, before.hash);
  },

  async 'it prints'({ page }) {
    const pdf = await page.pdf({ format: 'A4', printBackground: true });
    assert.ok(pdf.length > 20000 && pdf.subarray(0, 4).toString() === '%PDF');
  },

  async 'no request left the file and nothing complained'({ requests, complaints, url }) {
    const foreign = requests.filter((r) => r !== url && !r.startsWith('data:') && !r.startsWith('blob:'));
    assert.deepEqual(foreign, []);
    assert.deepEqual(complaints, []);
  },
};

const opened = await openReport(report, { width: 1280, height: 900 });
let failed = 0;
for (const [name, check] of Object.entries(checks)) {
  try {
    const skipped = await check(opened);
    console.log(`${skipped ? 'skip' : 'ok  '} ${name}${skipped ? ` (${skipped})` : ''}`);
  } catch (fault) {
    ++failed;
    console.log(`FAIL ${name}\n     ${fault.message}`);
  }
}
await opened.browser.close();
process.exit(failed ? 1 : 0);
