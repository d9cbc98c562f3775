// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of one cylinder, in words.
import { element } from './controls.js';

/// Marks cylinder `index` of `wood` ("Model" or "Regrown") and writes its reading into `panel`.
export function read(panel, words, wood, index, colours) {
  const { data } = wood;
  const i = index;
  wood.mark(i);
  const se = data.radius_se.length && Number.isFinite(data.radius_se[i]) ? ` ± ${(100 * data.radius_se[i]).toFixed(2)}` : '';
  const length = Math.hypot(...[0, 1, 2].map((c) => wood.end[3 * i + c] - wood.start[3 * i + c]));
  const height = 0.5 * (wood.start[3 * i + 2] + wood.end[3 * i + 2]);
  const born = data.birth[i] >= 0 ? `, born in cycle ${data.birth[i]}` : '';
  panel.hidden = false;
  panel.replaceChildren(
    `${words}, cylinder ${data.id[i]}: `,
    element('b', { id: 'picked-radius' }, `radius ${(100 * wood.radius[i]).toFixed(2)}${se} cm`),
    `, order ${data.order[i]}, ${colours.quality[data.quality[i]][0]}, length ${(100 * length).toFixed(1)} cm, ${height.toFixed(2)} m above the foot${born}`,
  );
}
