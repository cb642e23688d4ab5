#include "page_style.h"

namespace apriltrack {
namespace {

constexpr std::string_view kPageStyle = R"(
:root { color-scheme: light dark; --paper: #fff; --ink: #1e2228; --pale: #6b7480; --rule: #dde1e6;
  --tint: #f5f7f9; --accent: #0072b2; --path: #56b4e9; --good: #009e73; --warning: #d55e00; --alarm: #fdf1e8;
  --orange: #e69f00; --sky: #56b4e9; --green: #009e73; --blue: #0072b2; --vermilion: #d55e00; --purple: #cc79a7; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #15181c; --ink: #e4e7eb; --pale: #9aa3ad; --rule: #333a42; --tint: #1d2126;
    --accent: #56b4e9; --path: #2b7fb0; --good: #1fbf93; --warning: #f08a3c; --alarm: #2c211a;
    --green: #1fbf93; --blue: #3d93d6; --vermilion: #f0703a; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 1rem/1.6 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif;
  -webkit-text-size-adjust: 100%; }
main { max-width: 66rem; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.25; margin: 0 0 1.5rem; padding-bottom: 1rem;
  border-bottom: 3px solid var(--accent); text-wrap: balance; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 2.75rem 0 .75rem; }
p { max-width: 44rem; margin: 0 0 1rem; overflow-wrap: anywhere; }
figure { margin: 1.5rem 0; }
figure .wide { margin: 0; }
figure img, figure video { display: block; width: 100%; height: auto; border: 1px solid var(--rule);
  border-radius: 8px; background: #fff; }
figure video { background: #000; }
figure svg { display: block; width: 100%; height: auto; }
figure .pair { display: grid; gap: 1.25rem; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); }
.alarm { max-width: 48rem; margin: 0 0 .6rem; padding: .6rem .9rem; background: var(--alarm);
  border-left: 4px solid var(--warning); border-radius: 0 6px 6px 0; overflow-wrap: anywhere; }
ul { max-width: 46rem; margin: 0 0 1rem; padding-left: 1.2rem; }
li { margin: 0 0 .5rem; overflow-wrap: anywhere; }
figcaption, caption { color: var(--pale); font-size: .9rem; overflow-wrap: anywhere; }
figcaption { margin-top: .6rem; max-width: 44rem; }
.scene .view { position: relative; }
.scene canvas { display: block; width: 100%; height: min(34rem, 72vh); border: 1px solid var(--rule); border-radius: 8px;
  background: var(--tint); touch-action: none; cursor: grab; outline-offset: 2px; }
.scene .why { position: absolute; inset: 0; margin: auto; height: fit-content; padding: 1rem; text-align: center; color: var(--pale); }
.scene[data-state="drawn"] .why { display: none; }
.scene:not([data-state="drawn"]) canvas { height: 7rem; cursor: default; }
.scene:not([data-state="drawn"]) :is(.controls, figcaption) { display: none; }
.scene .tip { position: absolute; pointer-events: none; padding: .35rem .6rem; white-space: pre-line; font-size: .85rem; line-height: 1.4;
  max-width: 18rem; background: var(--paper); border: 1px solid var(--rule); border-radius: 6px; }
.scene .tip[hidden] { display: none; }
.bar { display: flex; flex-wrap: wrap; gap: .4rem 1rem; align-items: center; margin-top: .6rem; font-size: .9rem; }
.bar button { font: inherit; padding: .2rem .7rem; color: var(--ink); background: var(--tint); border: 1px solid var(--rule);
  border-radius: 6px; cursor: pointer; }
.bar input[type="range"] { accent-color: var(--accent); vertical-align: middle; }
.time input { flex: 1 1 12rem; }
.time output { min-width: 10rem; padding-left: .5rem; border-left: .6rem solid; font-variant-numeric: tabular-nums; }
.legend span::before { content: ""; display: inline-block; width: .8rem; height: .8rem; margin-right: .4rem; border-radius: 2px;
  background: var(--mark); vertical-align: -.05rem; }
.scene.full { position: fixed; inset: 0; z-index: 9; margin: 0; padding: .8rem; display: flex; flex-direction: column;
  background: var(--paper); }
.scene.full .view { flex: 1; min-height: 0; }
.scene.full canvas { height: 100%; }
.scene.full figcaption { display: none; }
.wide { overflow-x: auto; margin: 1.5rem 0; container-type: inline-size; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
caption { caption-side: bottom; text-align: left; padding-top: .6rem; position: sticky; left: 0; max-width: 100cqw; }
th, td { padding: .45rem .75rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--rule); }
thead th { color: var(--pale); font-size: .85rem; font-weight: 600; vertical-align: bottom;
  border-bottom: 2px solid var(--rule); }
tbody th { font-weight: 600; }
.dense th, .dense td { padding: .35rem .5rem; font-size: .88rem; }
.dense caption { max-width: min(60rem, 100cqw); }
th:first-child, td:first-child { padding-left: .25rem; }
.number { text-align: right; white-space: nowrap; }
thead .number { white-space: normal; }
pre { margin: 1.5rem 0; padding: .9rem 1.1rem; overflow-x: auto; background: var(--tint);
  border: 1px solid var(--rule); border-radius: 8px;
  font: .88rem/1.55 ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
@media (max-width: 40rem) {
  main { padding: 1.5rem 1rem 3rem; }
  h1 { font-size: 1.5rem; }
  .wide img, .wide svg { min-width: 42rem; }
  th, td { padding: .35rem .45rem; font-size: .86rem; }
  .dense th, .dense td { padding: .3rem .35rem; font-size: .82rem; }
  figure .wide, .wide:has(.dense) { background: linear-gradient(90deg, var(--paper) 30%, transparent) local 0 0 / 3rem 100% no-repeat,
    linear-gradient(270deg, var(--paper) 30%, transparent) local 100% 0 / 3rem 100% no-repeat,
    linear-gradient(90deg, var(--rule), transparent) 0 0 / 1rem 100% no-repeat,
    linear-gradient(270deg, var(--rule), transparent) 100% 0 / 1rem 100% no-repeat; }
}
@media print {
  :root { --paper: #fff; --ink: #000; --pale: #444; --rule: #bbb; --tint: #fff; --accent: #000; --path: #777; --good: #000;
    --warning: #000; --alarm: #fff; }
  main { max-width: none; padding: 0; }
  figure, tr, pre { break-inside: avoid; }
  h2 { break-after: avoid; }
  .alarm { border: 1px solid var(--rule); border-left-width: 4px; }
  .wide { overflow: visible; }
  .wide img, .wide svg { min-width: 0; }
  pre { white-space: pre-wrap; }
  figure video, .scene .controls .bar:not(.legend) { display: none; }
  .scene canvas, .scene:not([data-state="drawn"]) canvas { height: auto; }
}
)";

}  // namespace

std::string_view page_style() {
  return kPageStyle;
}

}  // namespace apriltrack
