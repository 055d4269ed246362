"""How the page looks: one column, light and dark, from a phone's width on."""

CSS = """
:root { color-scheme: light dark; --ink: #1c1c1c; --paper: #ffffff; --soft: #5a5f66;
  --line: #d9d9d9; --card: #f5f6f7; --accent: #0072b2; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e6e3; --paper: #16181c; --soft: #a7adb5; --line: #3a3e46; --card: #1f2228;
    --accent: #5cb8ff; }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; padding: 1.2rem 1rem 4rem; max-width: 60rem; background: var(--paper);
  color: var(--ink); font: 1rem/1.55 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: .2rem 0 .6rem; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; padding-top: .8rem;
  border-top: 1px solid var(--line); }
p { margin: .5rem 0; }
a { color: var(--accent); }
.soft, figcaption, summary { color: var(--soft); font-size: .9rem; }
.verdict { display: inline-block; padding: .1rem .7rem; border-radius: 1rem; font-weight: 600;
  color: var(--paper); background: var(--accent); }
.lead { font-size: 1.15rem; font-weight: 600; }
.note { background: var(--card); border-left: 4px solid var(--line); padding: .5rem .8rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); padding-bottom: .3rem; }
th, td { text-align: left; padding: .25rem .8rem .25rem 0; border-bottom: 1px solid var(--line);
  vertical-align: top; white-space: pre; }
th { font-weight: 600; white-space: pre-line; }
.right { text-align: right; }
figure { margin: .8rem 0 0; }
img { display: block; width: 100%; height: auto; }
details { margin-top: .6rem; }
code { font-size: .9em; }
"""
