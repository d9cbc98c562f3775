// SPDX-License-Identifier: GPL-3.0-or-later
// usage: node bundle.mjs OUT.cpp
// Bundles src/main.js with three.js into one script and writes it as a C++ file that defines viewer_bundle().
import { writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const result = await build({
  entryPoints: [join(here, 'src/main.js')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'inline',
  write: false,
});
const script = result.outputFiles[0].text.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '<\\!--');
const pieces = script.match(/[\s\S]{1,2000}/g).map((piece) => `    ${JSON.stringify(piece).replace(/\?\?/g, '?\\?')}`);
const text = `// Made by cli/report/viewer/bundle.mjs; not for editing.
#include "cli/report/viewer_bundle.h"

namespace dendrofit {

std::string_view viewer_bundle() {
  static constexpr char kScript[] =
${pieces.join('\n')};
  return {kScript, sizeof kScript - 1};
}

}  // namespace dendrofit
`;
writeFileSync(process.argv[2], text);
console.log(`viewer: ${(script.length / 1024).toFixed(0)} kB`);
