// SPDX-License-Identifier: GPL-3.0-or-later
// usage: node shot.mjs REPORT.html OUT_FOLDER     screenshots: wide, narrow, print (PDF)
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { openReport } from './browser.mjs';

const [report, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
for (const [name, width] of [['wide', 1280], ['narrow', 390]]) {
  const { browser, page } = await openReport(report, { width, height: 900 });
  await page.screenshot({ path: join(folder, `${name}.png`), fullPage: true });
  if (name === 'wide') await page.pdf({ path: join(folder, 'print.pdf'), format: 'A4', printBackground: true });
  await browser.close();
}
