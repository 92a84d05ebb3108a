// One engine highlighted everywhere: pointer or focus on anything of it pales the others.

/** @param {(engine: string | null) => void} chosen is told of each change */
export function linkEngines(chosen) {
  const marked = () => /** @type {NodeListOf<HTMLElement | SVGElement>} */ (document.querySelectorAll("[data-engine]"));
  // A row whose cells take the focus needs none of its own.
  for (const row of document.querySelectorAll("tr[data-engine]:not(:has([data-tip], a, button))")) row.setAttribute("tabindex", "0");
  /** @type {string | null} */
  let now = null;
  const choose = (/** @type {string | null} */ engine) => {
    if (engine === now) return;
    now = engine;
    for (const element of marked()) element.classList.toggle("dim", engine !== null && element.dataset.engine !== engine);
    chosen(engine);
  };
  const engineOf = (/** @type {EventTarget | null} */ target) => {
    const element = target instanceof Element ? target.closest("[data-engine]") : null;
    return element instanceof HTMLElement || element instanceof SVGElement ? element.dataset.engine ?? null : null;
  };
  document.addEventListener("pointerover", (event) => choose(engineOf(event.target) ?? engineOf(document.activeElement)));
  document.addEventListener("focusin", (event) => choose(engineOf(event.target)));
  document.addEventListener("focusout", () => choose(null));
}
