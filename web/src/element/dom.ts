// How is an element with its attributes and children written in one expression?

/** What an attribute can be: absent where it is false or null, empty where it is true. */
export type Attribute = string | number | boolean | null;

/** A new element. */
export function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  attributes: Readonly<Record<string, Attribute>> = {},
  ...children: readonly (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) setAttribute(made, key, value);
  made.append(...children);
  return made;
}

/** Sets or takes away an attribute. */
export function setAttribute(on: Element, name: string, value: Attribute): void {
  if (value === null || value === false) on.removeAttribute(name);
  else on.setAttribute(name, value === true ? "" : String(value));
}

/** A drawing of one path in a square of 24 units, hidden from screen readers. */
export function icon(path: string): SVGElement {
  const space = "http://www.w3.org/2000/svg";
  const drawing = document.createElementNS(space, "svg");
  drawing.setAttribute("viewBox", "0 0 24 24");
  drawing.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(space, "path");
  line.setAttribute("d", path);
  drawing.append(line);
  return drawing;
}

/** Calls `heard` for every event of this name until the signal ends it. */
export function listen<K extends keyof HTMLElementEventMap>(
  on: HTMLElement,
  name: K,
  heard: (event: HTMLElementEventMap[K]) => void,
  options: AddEventListenerOptions = {},
): void {
  on.addEventListener(name, heard, options);
}
