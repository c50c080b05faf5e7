/* How the page looks, and the little that it does. */
#include "cli/report/study.h"

#include <stddef.h>

const char *const cli_page_style[] = {
    ":root{color-scheme:light dark;--ink:#1b1f24;--soft:#5b6570;--paper:#fdfdfc;--card:#fff;"
    "--line:#dfe3e7;--front:#1b1f24;--code:#f3f5f7;--c0:#2f6fd0;--c1:#d2691e;--c2:#2a8f62;"
    "--c3:#9a3fb0;--c4:#b8860b;--c5:#c2334d;--c6:#4b7a8c;--c7:#6b6b6b}\n",
    "@media (prefers-color-scheme:dark){:root:not([data-theme=light]){--ink:#e8eaed;"
    "--soft:#9aa4ae;--paper:#14171a;--card:#1b1f24;--line:#31373e;--front:#e8eaed;"
    "--code:#23282e;--c0:#6ea8ff;--c1:#ff9a52;--c2:#5fd19b;--c3:#d48be6;--c4:#e5c04d;"
    "--c5:#ff7b8f;--c6:#8cc5da;--c7:#b0b0b0}}\n",
    ":root[data-theme=dark]{color-scheme:dark;--ink:#e8eaed;--soft:#9aa4ae;--paper:#14171a;"
    "--card:#1b1f24;--line:#31373e;--front:#e8eaed;--code:#23282e;--c0:#6ea8ff;--c1:#ff9a52;"
    "--c2:#5fd19b;--c3:#d48be6;--c4:#e5c04d;--c5:#ff7b8f;--c6:#8cc5da;--c7:#b0b0b0}\n",
    ":root[data-theme=light]{color-scheme:light}\n",
    "*{box-sizing:border-box}\n",
    "body{margin:0;background:var(--paper);color:var(--ink);"
    "font:16px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',sans-serif}\n",
    "main{max-width:1080px;margin:0 auto;padding:2.5rem 1.25rem 4rem}\n",
    "h1{font-size:1.9rem;line-height:1.2;margin:0 0 .4rem;letter-spacing:-.01em;"
    "overflow-wrap:anywhere}\n",
    "h2{font-size:1.3rem;margin:3rem 0 .4rem;padding-top:1.2rem;border-top:1px solid "
    "var(--line)}\n",
    "h3{font-size:1rem;margin:1.6rem 0 .4rem}\n",
    "p{margin:.4rem 0 .8rem;max-width:46rem}\n",
    ".quiet,figcaption,caption{color:var(--soft);font-size:.9rem}\n",
    ".facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:1px;"
    "background:var(--card);border:1px solid var(--line);border-radius:8px;overflow:hidden;"
    "margin:1.4rem 0}\n",
    ".facts div{box-shadow:0 0 0 1px var(--line);padding:.6rem .8rem}\n",
    ".facts dt{color:var(--soft);font-size:.8rem}\n",
    ".facts dd{margin:0;font-weight:600;font-variant-numeric:tabular-nums;"
    "overflow-wrap:anywhere}\n",
    "dl{margin:0}\n",
    "figure{margin:0}\n",
    ".pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,230px),1fr));"
    "gap:1rem;margin:1rem 0}\n",
    ".pictures img{width:100%;height:auto;display:block;background:var(--card);border:1px "
    "solid "
    "var(--line);border-radius:8px}\n",
    ".pictures strong{color:var(--ink);display:block}\n",
    ".ramp{display:grid;grid-template-columns:auto minmax(4rem,22rem) "
    "auto;justify-content:start;gap:.6rem;"
    "align-items:center;font-size:.85rem;color:var(--soft)}\n",
    ".ramp i{height:.7rem;border-radius:4px;display:block;-webkit-print-color-adjust:exact;"
    "print-color-adjust:exact}\n",
    "svg{display:block;width:100%;height:auto;font:12px system-ui,sans-serif}\n",
    ".plot{background:var(--card);border:1px solid var(--line);border-radius:8px;"
    "max-width:860px;margin:.8rem 0}\n",
    ".grid{stroke:var(--line);stroke-width:1}\n",
    ".tick{fill:var(--soft);font-size:11.5px}.label{fill:var(--ink);font-size:12.5px}\n",
    ".front{fill:none;stroke:var(--front);stroke-width:1.5;stroke-dasharray:5 4;opacity:.65}\n",
    ".dot circle{fill:var(--card);stroke:var(--c);stroke-width:2}\n",
    ".dot.best circle{fill:var(--c)}\n",
    ".dot text{fill:var(--soft);font-size:11px}.dot.best text{fill:var(--ink);"
    "font-weight:600}\n",
    ".dot:hover circle,.dot:focus circle{stroke-width:4}.dot{outline:none}\n",
    ".g0{--c:var(--c0)}.g1{--c:var(--c1)}.g2{--c:var(--c2)}.g3{--c:var(--c3)}"
    ".g4{--c:var(--c4)}.g5{--c:var(--c5)}.g6{--c:var(--c6)}.g7{--c:var(--c7)}\n",
    ".key{display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;font-size:.9rem;margin:.2rem 0}\n",
    ".key i{display:inline-block;width:.75rem;height:.75rem;border-radius:50%;"
    "background:var(--c);margin-right:.4rem}\n",
    ".key em{display:inline-block;width:1.6rem;border-top:2px dashed var(--front);"
    "margin:0 .4rem .25rem 0}\n",
    ".wide{overflow-x:auto;margin:1rem 0}\n",
    "table{border-collapse:collapse;width:100%;font-size:.88rem;"
    "font-variant-numeric:tabular-nums}\n",
    "th{font-weight:600;color:var(--soft);text-align:right;vertical-align:bottom;"
    "padding:.3rem .55rem;white-space:nowrap}\n",
    "td{padding:.45rem .55rem 0;text-align:right;white-space:nowrap}\n",
    "th.w,td.w{text-align:left}\n",
    "tbody{border-top:1px solid var(--line)}\n",
    "tbody.best td.w{font-weight:600}\n",
    "td.c{text-align:left;padding:.05rem .55rem .45rem;white-space:normal}\n",
    "code{font:.82rem/1.45 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;"
    "overflow-wrap:anywhere;white-space:pre-wrap}\n",
    "td.c code,p code{color:var(--soft)}\n",
    "button{font:inherit;font-size:.75rem;color:var(--soft);background:var(--code);border:0;"
    "border-radius:4px;padding:.05rem .45rem;margin-left:.4rem;cursor:pointer}\n",
    "button:hover{color:var(--ink)}\n",
    ".picks{padding-left:1.1rem;margin:.4rem 0}\n",
    ".hists{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,230px),1fr));"
    "gap:1.4rem}\n",
    ".bars{margin:.6rem 0}.bars rect{fill:var(--c0)}.base{stroke:var(--soft)}\n",
    "@media (max-width:560px){main{padding:1.4rem .8rem 3rem}h1{font-size:1.5rem}"
    ".plot .tick,.plot .dot text{font-size:17px}.plot .label{font-size:18px}}\n",
    "@media print{:root,:root[data-theme]{--ink:#000;--soft:#444;--paper:#fff;--card:#fff;"
    "--line:#bbb;--front:#000}body{font-size:10.5pt}main{max-width:none;padding:0}"
    "button{display:none}.wide{overflow:visible}h2{break-after:avoid}"
    "figure,.plot,tbody{break-inside:avoid}table{font-size:8pt}td,th{padding-left:.25rem;"
    "padding-right:.25rem}a{color:inherit}}\n",
    NULL};

/* Copies a command; where the clipboard is not to be had, it is selected. No sign that XML
 * would take for its own. */
const char cli_page_script[] =
    "document.querySelectorAll('code[data-copy]').forEach(function(code){"
    "var b=document.createElement('button');b.type='button';b.textContent='copy';"
    "b.onclick=function(){function pick(){var r=document.createRange();"
    "r.selectNodeContents(code);var s=getSelection();s.removeAllRanges();s.addRange(r);"
    "b.textContent='selected'}"
    "if(navigator.clipboard){navigator.clipboard.writeText(code.textContent).then(function(){"
    "b.textContent='copied'},pick)}else{pick()}};code.after(b)});\n";
