// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/page_style.h"

namespace dendrofit {

std::string_view page_style() {
  return R"css(
:root { --ink: #23282e; --quiet: #5a636d; --line: #d9dcd6; --paper: #fafaf8; --card: #fff; --accent: #005aa0; --warn: #8a4b00; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", Arial, sans-serif; }
main, header, footer { max-width: 1240px; margin: 0 auto; padding: 0 20px; }
header { padding-top: 26px; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; margin: 38px 0 12px; padding-bottom: 4px; border-bottom: 2px solid var(--line); }
p { margin: 0 0 10px; max-width: 75ch; }
.quiet { color: var(--quiet); }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(130px, 1fr)); gap: 10px; margin: 18px 0 6px; padding: 0; list-style: none; }
.facts li { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 10px 12px; }
.facts b { display: block; font-size: 1.35rem; line-height: 1.25; font-variant-numeric: tabular-nums; }
.facts span { color: var(--quiet); font-size: .84rem; }
.facts small { display: block; color: var(--quiet); font-size: .78rem; font-variant-numeric: tabular-nums; }
.warnings { border-left: 4px solid #d08700; background: #fff6e3; padding: 10px 16px; border-radius: 0 8px 8px 0; margin: 18px 0; }
.warnings ul { margin: 4px 0 0; padding-left: 20px; }
.warnings li { overflow-wrap: anywhere; }
figure { margin: 0; }
figcaption { font-weight: 600; margin-bottom: 4px; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 370px), 1fr)); gap: 18px; }
.plot { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 12px 12px 6px; break-inside: avoid; }
.plot > svg { width: 100%; height: auto; display: block; }
.plot text { font: 13px system-ui, "Segoe UI", Roboto, "DejaVu Sans", Arial, sans-serif; fill: #3b4249; }
.plot text.label { fill: var(--quiet); }
.plot text.small { font-size: 11px; fill: var(--quiet); }
.plot .grid { stroke: #e6e8e3; stroke-width: 1; }
.plot .axis { stroke: #8a9198; stroke-width: 1; }
.plot .prior { fill: #e4e6e1; }
.legend { display: flex; flex-wrap: wrap; gap: 2px 14px; font-size: .84rem; color: #3b4249; }
.legend span { display: inline-flex; align-items: center; gap: 6px; }
.scroll { overflow-x: auto; margin: 0 0 14px; }
table { border-collapse: collapse; width: 100%; background: var(--card); font-size: .93rem; }
caption { text-align: left; font-weight: 600; padding: 2px 0 6px; background: var(--paper); }
th, td { text-align: left; padding: 6px 10px; border-bottom: 1px solid var(--line); vertical-align: top; overflow-wrap: break-word; }
thead th { color: var(--quiet); font-weight: 600; border-bottom: 2px solid var(--line); }
tbody th { font-weight: 500; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td .quiet { white-space: nowrap; font-size: .86rem; }
.flag { color: var(--warn); font-weight: 600; white-space: nowrap; }
#plot-parameters { grid-column: 1 / -1; max-width: 620px; }
.picture img { width: auto; max-width: 100%; height: auto; max-height: 960px; margin: 0 auto; display: block; border: 1px solid var(--line); border-radius: 8px; background: var(--paper); }
code { font: .88em ui-monospace, "DejaVu Sans Mono", Consolas, monospace; overflow-wrap: anywhere; }
tbody th code { overflow-wrap: normal; }
@media (min-width: 641px) { td.n { white-space: nowrap; } }
footer { color: var(--quiet); font-size: .86rem; padding-top: 26px; padding-bottom: 40px; }
#viewer { position: relative; background: var(--card); border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
#viewer .stage { position: relative; height: min(72vh, 680px); min-height: 320px; background: #eef0ec; touch-action: none; }
#viewer canvas { display: block; width: 100%; height: 100%; outline-offset: -3px; }
#viewer .bar { display: flex; flex-wrap: wrap; gap: 8px 18px; align-items: center; padding: 10px 14px; border-bottom: 1px solid var(--line); font-size: .93rem; }
#viewer .bar + .stage + .bar { border-bottom: 0; border-top: 1px solid var(--line); }
#viewer .views { display: inline-flex; gap: 6px; }
#viewer label { display: inline-flex; align-items: center; gap: 6px; min-height: 28px; }
#viewer input[type=checkbox] { width: 18px; height: 18px; margin: 0; }
#viewer input[type=range] { width: min(340px, 56vw); }
#viewer select, #viewer button { font: inherit; padding: 4px 10px; border: 1px solid #b9beb6; border-radius: 6px; background: #fff; color: var(--ink); min-height: 32px; }
#viewer button:hover { border-color: var(--accent); }
#viewer .reading { position: absolute; left: 10px; bottom: 10px; max-width: calc(100% - 20px); background: rgba(255, 255, 255, .94); border: 1px solid var(--line); border-radius: 6px; padding: 6px 10px; font-size: .88rem; pointer-events: none; }
#viewer .reading b { font-variant-numeric: tabular-nums; }
#viewer .swatch { display: inline-block; width: 12px; height: 12px; border-radius: 2px; margin-right: 5px; vertical-align: -1px; }
#viewer .missing { padding: 22px; }
@media (max-width: 640px) {
  body { font-size: 15px; }
  main, header, footer { padding-left: 12px; padding-right: 12px; }
  #viewer .stage { height: 46vh; }
  #viewer .bar { gap: 4px 14px; padding: 8px 10px; }
  .picture { overflow-x: auto; }
  .picture img { width: 900px; max-width: none; max-height: none; }
  table.cards thead { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
  table.cards tr { display: block; border-bottom: 1px solid var(--line); padding: 6px 0; }
  table.cards th, table.cards td { display: flex; justify-content: space-between; gap: 14px; border: 0; padding: 2px 10px; text-align: right; }
  table.cards tbody th { display: block; font-weight: 600; text-align: left; }
  table.cards td:has(> span:empty) { display: none; }
  table.cards td::before { content: attr(data-name); color: var(--quiet); text-align: left; flex: none; max-width: 50%; }
}
@media print {
  @page { margin: 14mm; }
  body { background: #fff; font-size: 10.5pt; }
  main, header, footer { max-width: none; padding: 0; }
  #view { display: none; }
  h2 { break-after: avoid; }
  .plots { grid-template-columns: 1fr 1fr; gap: 8px; }
  .facts { grid-template-columns: repeat(4, 1fr); gap: 6px; }
  .facts b { font-size: 1.1rem; }
  .scroll table { font-size: 9.5pt; }
  th, td { padding: 3px 6px; }
  #table-parameters { font-size: 8.5pt; }
  #table-parameters td:nth-child(2) { min-width: 9em; }
  td.n, .flag { white-space: normal; }
  thead { display: table-header-group; }
  .plot, .facts li, .warnings { break-inside: avoid; }
  tr { break-inside: avoid; }
  .scroll { overflow: visible; }
}
)css";
}

}  // namespace dendrofit
