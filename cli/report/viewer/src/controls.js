// SPDX-License-Identifier: GPL-3.0-or-later
// The bars of checkboxes, lists and sliders round the picture. Text only ever enters through textContent.

export function element(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key in node && typeof value === 'boolean') node[key] = value;
    else node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}

export function checkbox(id, words, checked, change) {
  const box = element('input', { type: 'checkbox', id, onchange: () => change(box.checked) });
  box.checked = checked;
  return element('label', { for: id }, box, words);
}

export function select(id, words, choices, change) {
  const list = element('select', { id, onchange: () => change(list.value) });
  for (const [value, label] of choices) list.append(element('option', { value }, label));
  return element('label', { for: id }, words, list);
}

export function button(words, press, more = {}) {
  return element('button', { type: 'button', onclick: press, ...more }, words);
}

export function legend(rows) {
  return rows.map(([colour, words]) => {
    const swatch = element('span', { class: 'swatch' });
    swatch.style.background = colour;
    return element('span', {}, swatch, words);
  });
}
