/**
 * An element with attributes and children; an attribute that is false is left out.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag @param {Record<string, string | number | boolean>} [attributes] @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== false) made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children);
  return made;
}

/** @param {string} name @param {() => void} act @param {Record<string, string>} [attributes] */
export function button(name, act, attributes = {}) {
  const made = element("button", { type: "button", ...attributes }, name);
  made.addEventListener("click", act);
  return made;
}

/** @param {boolean} on @param {(on: boolean) => void} act @param {...(Node | string)} label */
export function tick(on, act, ...label) {
  const box = element("input", { type: "checkbox", checked: on });
  box.addEventListener("change", () => act(box.checked));
  return element("label", {}, box, ...label);
}

/** @param {string} name @param {[string, string][]} options value and text @param {string} value @param {(value: string) => void} act */
export function choice(name, options, value, act) {
  const list = element("select", {}, ...options.map(([key, text]) => element("option", { value: key, selected: key === value }, text)));
  list.addEventListener("change", () => act(list.value));
  return element("label", {}, `${name} `, list);
}

/** A short line in an engine's look. @param {string} colour @param {string} dash */
export function swatch(colour, dash) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("class", "swatch");
  svg.setAttribute("viewBox", "0 0 28 8");
  svg.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(svg.namespaceURI, "line");
  for (const [name, at] of Object.entries({ x1: 0, y1: 4, x2: 28, y2: 4, stroke: colour, "stroke-width": 3 })) line.setAttribute(name, String(at));
  if (dash) line.setAttribute("stroke-dasharray", dash);
  svg.append(line);
  return svg;
}
