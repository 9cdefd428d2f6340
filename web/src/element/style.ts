// How does the element look?

/** Its style sheet: light and dark, from 240 pixels wide. */
export const STYLE = `
:host {
  --ink: light-dark(#1c2024, #e9ebee);
  --quiet: light-dark(#5c656e, #9aa3ac);
  --ground: light-dark(#ffffff, #15181b);
  --line: light-dark(#d9dde1, #30363c);
  --accent: light-dark(#0b62c4, #78b4ff);
  color-scheme: light dark;
  display: grid;
  grid-template-rows: minmax(0, 1fr) auto;
  position: relative;
  container: foveal / inline-size;
  width: 100%;
  aspect-ratio: 16 / 10;
  min-width: 15rem;
  min-height: 12rem;
  overflow: hidden;
  color: var(--ink);
  background: var(--ground);
  font: 0.875rem/1.4 system-ui, sans-serif;
}
:host([hidden]), [hidden] { display: none !important; }
.picture { position: relative; overflow: hidden; }
.over { position: absolute; inset: 0; pointer-events: none; }
.over > * { pointer-events: auto; }
.stage {
  position: absolute;
  inset: 0;
  overflow: hidden;
  background: #000;
  cursor: grab;
  touch-action: none;
  user-select: none;
  -webkit-user-select: none;
}
.stage.held { cursor: grabbing; }
.stage canvas, .stage .poster { position: absolute; inset: 0 auto auto 0; display: block; }
.stage canvas { transform-origin: 0 0; }
.stage .poster {
  width: 100%;
  height: 100%;
  object-fit: contain;
  filter: blur(0.25rem);
  transform: scale(1.02);
}
:focus { outline: none; }
:focus-visible { outline: 3px solid var(--accent); outline-offset: -3px; }
.bar {
  display: flex;
  flex-wrap: wrap;
  align-items: center;
  gap: 0.125rem;
  padding: 0.25rem 0.375rem;
  border-top: 1px solid var(--line);
}
.bar button, .bar .time { flex: none; }
button {
  min-width: 2.5rem;
  min-height: 2.5rem;
  padding: 0.5rem;
  border: 0;
  border-radius: 0.375rem;
  color: inherit;
  background: none;
  font: inherit;
  cursor: pointer;
}
button:hover { background: color-mix(in srgb, currentColor 12%, transparent); }
button[aria-pressed="true"] { color: var(--accent); }
button:disabled { opacity: 0.4; cursor: default; }
button.word { padding: 0.375rem 0.875rem; border: 1px solid var(--line); }
svg {
  display: block;
  width: 1.5rem;
  height: 1.5rem;
  fill: none;
  stroke: currentColor;
  stroke-width: 2;
  stroke-linecap: round;
  stroke-linejoin: round;
}
input[type="range"] {
  flex: 1 1 8rem;
  min-width: 6rem;
  min-height: 2rem;
  margin: 0 0.5rem;
  accent-color: var(--accent);
}
.time { padding: 0 0.375rem; color: var(--quiet); font-variant-numeric: tabular-nums; }
@container foveal (width < 34rem) {
  input[type="range"] { order: -1; flex-basis: 100%; margin: 0 0.25rem; }
  .time { margin-inline-end: auto; }
}
.figures, .keys {
  position: absolute;
  max-width: calc(100% - 1rem);
  padding: 0.625rem 0.75rem;
  border-radius: 0.5rem;
  color: #eef1f4;
  background: rgb(12 15 18 / 82%);
  color-scheme: dark;
}
.figures {
  inset-block-start: 0.5rem;
  inset-inline-start: 0.5rem;
  max-height: calc(100% - 1rem);
  overflow: auto;
  box-sizing: border-box;
}
.figures dl {
  display: grid;
  grid-template-columns: auto auto;
  gap: 0.125rem 0.875rem;
  margin: 0 0 0.5rem;
}
.figures dt { color: #aab4bd; }
.figures dd { margin: 0; text-align: end; font-variant-numeric: tabular-nums; }
.figures p { max-width: 18rem; margin: 0 0 0.5rem; color: #aab4bd; font-size: 0.75rem; }
.figures label { display: block; padding: 0.25rem 0; }
.figures select { font: inherit; min-height: 2rem; }
.figures :focus-visible { outline-color: #78b4ff; }
dialog.keys {
  inset: 0;
  margin: auto;
  border: 0;
}
dialog.keys table { border-spacing: 0.75rem 0.25rem; }
dialog.keys th { text-align: start; font-weight: 600; white-space: nowrap; }
dialog.keys kbd { font: inherit; margin-inline-end: 0.5rem; }
dialog.keys::backdrop { background: rgb(0 0 0 / 40%); }
.status {
  position: absolute;
  inset-block-end: 0.75rem;
  inset-inline: 0.75rem;
  width: fit-content;
  max-width: calc(100% - 1.5rem);
  box-sizing: border-box;
  margin: 0 auto;
  padding: 0.375rem 0.75rem;
  border-radius: 0.5rem;
  color: #eef1f4;
  background: rgb(12 15 18 / 82%);
  pointer-events: none;
}
.status:empty { display: none; }
.status.quiet {
  width: 1px;
  height: 1px;
  padding: 0;
  overflow: hidden;
  clip-path: inset(50%);
  white-space: nowrap;
}
.problem {
  position: absolute;
  inset: 0;
  display: grid;
  place-content: center;
  justify-items: center;
  gap: 1rem;
  padding: 1rem;
  overflow: auto;
  color: #eef1f4;
  background: rgb(12 15 18 / 88%);
  text-align: center;
  color-scheme: dark;
}
.problem p { max-width: 34rem; margin: 0; }
.note { padding: 0.5rem 0.75rem; border-top: 1px solid var(--line); }
.note p { margin: 0; }
:host(:fullscreen) { aspect-ratio: auto; }
@media (prefers-reduced-motion: no-preference) {
  .poster { transition: opacity 0.2s; }
}
@media (forced-colors: active) {
  button { border: 1px solid ButtonText; }
}
`;
