// Shared by every widget: DOM helpers, colours of the page's theme, and the message on failure.
// Python joins a widget's files into one ES module (front_end.py), so nothing is imported here.

/** Make an element; attributes named on… are listeners, the rest are set as written. */
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined) node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
}

/** A button with a text, or with an icon given as an SVG path in a 16 × 16 box. */
function button(label, onclick, { icon = null, title = label } = {}) {
  const node = element("button", { type: "button", onclick, title });
  if (icon === null) {
    node.textContent = label;
  } else {
    node.className = "pf-icon";
    node.setAttribute("aria-label", label);
    setIcon(node, icon);
  }
  return node;
}

function setIcon(node, path) {
  node.innerHTML = `<svg viewBox="0 0 16 16" aria-hidden="true"><path d="${path}"/></svg>`;
}

/** The outermost element of a widget. Notebook shortcuts must not fire while it has the focus. */
function makeRoot(el, kind, label) {
  const root = element("div", {
    class: `pf-widget pf-${kind}`,
    role: "group",
    "aria-label": label,
    "data-lm-suppress-shortcuts": "true", // else "d d" or an arrow would act on the cell
  });
  el.append(root);
  return root;
}

/** Any CSS colour as [red, green, blue]; the canvas does the parsing. */
const parseColour = (() => {
  const known = new Map();
  let probe = null;
  return (text) => {
    if (!known.has(text)) {
      probe ??= Object.assign(document.createElement("canvas"), { width: 1, height: 1 })
        .getContext("2d", { willReadFrequently: true });
      probe.clearRect(0, 0, 1, 1);
      probe.fillStyle = text;
      probe.fillRect(0, 0, 1, 1);
      const [red, green, blue, alpha] = probe.getImageData(0, 0, 1, 1).data;
      known.set(text, { rgb: [red, green, blue], alpha: alpha / 255 });
    }
    return known.get(text);
  };
})();

/** Mix two colours: 0 gives the first, 1 the second. */
function mix(first, second, share) {
  const a = parseColour(first).rgb;
  const b = parseColour(second).rgb;
  return `rgb(${a.map((value, i) => Math.round(value + (b[i] - value) * share)).join(",")})`;
}

/** Read the palette from the style sheet, and tell it whether the page is light or dark. */
function readPalette(root) {
  const style = getComputedStyle(root);
  const read = (name) => style.getPropertyValue(`--pf-${name}`).trim();
  const [red, green, blue] = parseColour(read("paper")).rgb;
  const dark = 0.2126 * red + 0.7152 * green + 0.0722 * blue < 110;
  root.dataset.theme = dark ? "dark" : "light";
  const names = "paper ink muted edge left right core met missed grid grid-strong shadow focus font";
  const palette = Object.fromEntries(names.split(" ").map((name) => [name, read(name)]));
  return { ...palette, dark };
}

/** Call back when the page changes its theme; returns a function that stops watching. */
function watchTheme(callback) {
  const observer = new MutationObserver(callback);
  const options = {
    attributes: true,
    attributeFilter: ["class", "style", "data-theme", "data-jp-theme-light", "data-jp-theme-name"],
  };
  observer.observe(document.body, options);
  observer.observe(document.documentElement, options);
  return () => observer.disconnect();
}

/** Keep a canvas as large as its box in device pixels; calls back with its size in CSS pixels. */
function fitCanvas(canvas, callback) {
  const observer = new ResizeObserver(() => {
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    if (width < 1 || height < 1) return; // hidden tab: keep what there is
    canvas.width = Math.round(canvas.parentElement.clientWidth * ratio);
    canvas.height = Math.round(canvas.parentElement.clientHeight * ratio);
    callback(canvas.parentElement.clientWidth, canvas.parentElement.clientHeight, ratio);
  });
  observer.observe(canvas.parentElement);
  return () => observer.disconnect();
}

/** The floats of a Bytes trait, which arrives as a DataView at any offset. */
function floats(view) {
  if (!view || !view.byteLength) return new Float32Array(0);
  const { buffer, byteOffset, byteLength } = view;
  return new Float32Array(buffer.slice(byteOffset, byteOffset + byteLength));
}

/** Subscribe to several traits at once, one call per message; returns a function that stops it. */
function onTraits(model, names, callback) {
  let waiting = false;
  const listener = () => {
    if (waiting) return;
    waiting = true;
    queueMicrotask(() => {
      waiting = false;
      callback();
    });
  };
  const events = names.map((name) => `change:${name}`);
  events.forEach((event) => model.on(event, listener));
  return () => events.forEach((event) => model.off(event, listener));
}

/** Wrap a render function: if it throws, the page says so instead of staying empty. */
function guarded(name, render) {
  return (context) => {
    try {
      return render(context);
    } catch (error) {
      const text = `The ${name} could not start in this browser: ${error.message}. ` +
        "Reload the page; if it stays like this, try a current Firefox, Chrome or Safari.";
      context.el.replaceChildren(
        element("div", { class: "pf-widget" }, element("div", { class: "pf-failure", role: "alert" }, text)),
      );
      console.warn(`projflow_lite ${name}:`, error);
      return undefined;
    }
  };
}

/** The 2D context of a canvas, or an error a reader understands. */
function context2d(canvas) {
  const context = canvas.getContext("2d");
  if (!context) throw new Error("it gives no 2D drawing surface (canvas)");
  return context;
}
