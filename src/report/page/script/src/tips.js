// Exact values on hover and on focus. The arrows go from value to value of one figure or table,
// so that Tab passes each of them in one step.

/** @returns {(text: string | null, event: PointerEvent) => void} says a text where the pointer is, or nothing */
export function linkTips() {
  const tip = document.createElement("div");
  tip.id = "tip";
  tip.setAttribute("role", "tooltip");
  tip.hidden = true;
  document.body.append(tip);

  /** @param {string} text @param {number} left @param {number} top pixels of the window */
  const put = (text, left, top) => {
    tip.textContent = text;
    tip.hidden = false;
    const size = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, Math.min(innerWidth - size.width - 4, left + 12))}px`;
    tip.style.top = `${top - size.height - 10 < 4 ? top + 18 : top - size.height - 10}px`;
  };
  /** Whether a figure says values where the pointer is. */
  let said = false;
  const hide = () => {
    tip.hidden = true;
  };
  /** @param {EventTarget | null} target @param {number} [x] @param {number} [y] pixels of the window */
  const show = (target, x, y) => {
    const element = target instanceof Element ? target.closest("[data-tip]") : null;
    if (!element) return said ? undefined : hide();
    const box = element.getBoundingClientRect();
    put(element.getAttribute("data-tip") ?? "", x ?? box.left + box.width / 2, y ?? box.top);
  };
  document.addEventListener("pointermove", (event) => show(event.target, event.clientX, event.clientY));
  document.addEventListener("pointerdown", (event) => show(event.target, event.clientX, event.clientY));
  document.addEventListener("focusin", (event) => show(event.target));
  document.addEventListener("focusout", hide);
  // Tab may scroll to what it reaches: the tip goes along.
  document.addEventListener("scroll", () => show(document.activeElement), { passive: true });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") hide();
  });

  /** @type {Map<Element, Element[]>} */
  const groups = new Map();
  for (const element of document.querySelectorAll("[data-tip]")) {
    const own = element.matches("a, button, input, select, summary, [tabindex]");
    const group = own ? null : element.closest("svg, table");
    if (element instanceof SVGElement && !element.hasAttribute("role")) {
      element.setAttribute("role", "img");
      element.setAttribute("aria-label", element.getAttribute("data-tip") ?? "");
    }
    if (group) groups.set(group, [...(groups.get(group) ?? []), element]);
    else if (!own) element.setAttribute("tabindex", "0");
  }
  for (const [group, elements] of groups) {
    // An image has no parts for a screen reader; a group has.
    if (group.getAttribute("role") === "img") group.setAttribute("role", "group");
    elements.forEach((element, k) => element.setAttribute("tabindex", k ? "-1" : "0"));
    group.addEventListener("keydown", (event) => {
      const key = event instanceof KeyboardEvent ? event.key : "";
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[key];
      const at = elements.findIndex((element) => element === document.activeElement);
      const next = step && at >= 0 ? elements[at + step] : undefined;
      if (!(next instanceof HTMLElement || next instanceof SVGElement)) return;
      event.preventDefault();
      elements[at].setAttribute("tabindex", "-1");
      next.setAttribute("tabindex", "0");
      next.focus();
    });
  }

  return (text, event) => {
    said = text !== null;
    if (text === null) hide();
    else put(text, event.clientX, event.clientY);
  };
}
