// SPDX-License-Identifier: GPL-3.0-or-later
// usage: node laz_points.js FILE.laz
// Writes the file's point records, decompressed, one after another to standard output, and nothing else. A complaint
// is one line on standard error and exit code 1.
'use strict';
const fs = require('fs');

function write_all(buffer) {
  for (let done = 0; done < buffer.length;) {
    try {
      done += fs.writeSync(1, buffer, done);
    } catch (error) {
      if (error.code !== 'EAGAIN') throw error;
    }
  }
}

async function main(path) {
  const { createLazPerf } = require('laz-perf');
  const file = fs.readFileSync(path);
  const laz = await createLazPerf({ print: () => {}, printErr: () => {} });
  const source = laz._malloc(file.length);
  if (source === 0) throw new Error('too large for this decoder (about 1.5 GB); use las2las or lasmerge to cut it');
  laz.HEAPU8.set(file, source);
  const reader = new laz.LASZip();
  reader.open(source, file.length);
  const length = reader.getPointLength();
  const count = reader.getCount();
  const target = laz._malloc(length);
  const points_a_block = 16384;
  const block = Buffer.alloc(points_a_block * length);
  for (let i = 0; i < count;) {
    const points = Math.min(points_a_block, count - i);
    for (let k = 0; k < points; ++k) {
      reader.getPoint(target);
      block.set(laz.HEAPU8.subarray(target, target + length), k * length);  // the heap may have moved
    }
    write_all(block.subarray(0, points * length));
    i += points;
  }
}

main(process.argv[2]).then(() => process.exit(0), (error) => {
  const words = error && error.message ? error.message : String(error);
  process.stderr.write(words.split('\n')[0].slice(0, 200) + '\n');
  process.exit(error && error.code === 'MODULE_NOT_FOUND' ? 4 : error && error.code === 'EPIPE' ? 0 : 1);
});
