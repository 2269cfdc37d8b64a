// SPDX-License-Identifier: Apache-2.0
// Small helpers around the page's elements.

/** The element of index.html with this id. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) {
    throw new Error(`index.html has no #${id}`);
  }
  return found as T;
}

type Attributes = Record<string, string | boolean | ((event: Event) => void)>;

/** Makes an element. Attributes that are functions listen; texts are never read as HTML. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') {
      element.addEventListener(name, value);
    } else if (typeof value === 'boolean') {
      element.toggleAttribute(name, value);
    } else {
      element.setAttribute(name, value);
    }
  }
  element.append(...children);
  return element;
}

/** Makes an element of a drawing. */
export function draw(tag: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, String(value));
  }
  element.textContent = text;
  return element;
}

/** Offers a file to keep. */
export function download(name: string, parts: BlobPart[], type: string): void {
  const address = URL.createObjectURL(new Blob(parts, { type }));
  make('a', { href: address, download: name }).click();
  window.setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** Joints to choose from, where a board tells others than there were. */
export function jointOptions(select: HTMLSelectElement, joints: { name: string }[] | undefined): void {
  if (joints !== undefined && joints.length > 0 && select.options.length !== joints.length) {
    options(select, joints.map((one) => one.name));
  }
}

export function options(select: HTMLSelectElement, names: string[], chosen?: string): void {
  select.replaceChildren(...names.map((name) => make('option', { value: name, selected: name === chosen }, name)));
}
