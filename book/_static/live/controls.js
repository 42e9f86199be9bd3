// The few ipywidgets that notebooks of this book use, as plain HTML. Each gets a model and gives an
// element. A control without a kernel behind it is built disabled; start.js says why beside it.

{
  const { element, controls } = Live;
  let serial = 0;

  /** A description and a control, tied together for screen readers. */
  function row(model, control, ...more) {
    const id = (control.id = `live-${(serial += 1)}`);
    const label = element("label", { for: id, class: "live-label" });
    const show = () => { label.textContent = model.get("description") ?? ""; };
    model.on("change:description", show);
    show();
    return asleep(model, control, element("div", { class: "live-row" }, label, control, ...more));
  }

  /** A control that nothing answers looks so on purpose, and says why to whoever tries it. */
  function asleep(model, control, node) {
    if (!Live.records.isSilent(model)) return node;
    control.disabled = true;
    node.classList.add("live-asleep");
    node.title = "Needs Python, which does not run in this page";
    return node;
  }

  /** Change a model as a hand would. */
  function put(model, name, value) {
    model.set(name, value);
    model.save_changes();
  }

  const boxes = (kind) => (model) => {
    const children = model.get("children").map((child) => Live.view(model.linked(child)));
    return element("div", { class: `live-box ${kind}` }, ...children);
  };

  /** The places of a slider: those that were recorded, or all of them. */
  function places(model, trait) {
    const recorded = Live.records.stopsOf(model.id, trait);
    if (recorded) return recorded;
    if (trait === "index") return model.get("_options_labels").map((_, k) => k);
    const [low, high, step] = ["min", "max", "step"].map((name) => model.get(name));
    const every = Array.from({ length: Math.round((high - low) / step) + 1 }, (_, k) => low + k * step);
    return model.name === "FloatLogSliderModel" ? every.map((power) => model.get("base") ** power) : every;
  }

  function nearest(list, value) {
    return list.reduce((best, place, k) => (Math.abs(place - value) < Math.abs(list[best] - value) ? k : best), 0);
  }

  const slider = (trait, text) => (model) => {
    let list = places(model, trait);
    const input = element("input", { type: "range", min: 0, step: 1 });
    const output = element("output", { class: "live-number" });
    const show = () => {
      // A recording may shorten the slider: the steps of a sampler, for example.
      const fits = (place) => !(model.name === "IntSliderModel" && place > model.get("max"));
      list = places(model, trait).filter(fits);
      input.max = list.length - 1;
      input.value = nearest(list, model.get(trait));
      output.textContent = text(model, list[input.value]);
      input.setAttribute("aria-valuetext", output.textContent);
    };
    input.addEventListener("input", () => put(model, trait, list[input.value]));
    model.on(`change:${trait} change:max`, show);
    const built = row(model, input, ...(model.get("readout") === false ? [] : [output]));
    show();
    return built;
  };

  const number = (model, value) => {
    const digits = /\.(\d+)f/.exec(model.get("readout_format") ?? "");
    return digits ? value.toFixed(Number(digits[1])) : String(Math.round(value * 1e6) / 1e6);
  };

  function choice(model) {
    const input = element("select", {}, ...model.get("_options_labels").map((label, k) =>
      element("option", { value: k, disabled: !(places(model, "index").includes(k)) }, label)));
    const show = () => { input.value = model.get("index"); };
    input.addEventListener("change", () => put(model, "index", Number(input.value)));
    model.on("change:index", show);
    show();
    return row(model, input);
  }

  function checkbox(model) {
    const input = element("input", { type: "checkbox" });
    const show = () => { input.checked = model.get("value"); };
    input.addEventListener("change", () => put(model, "value", input.checked));
    model.on("change:value", show);
    show();
    const built = row(model, input);
    built.classList.add("live-check");
    return built;
  }

  function text(model) {
    const input = element("input", { type: "text", disabled: true, value: model.get("value") });
    return row(model, input);
  }

  function button(model) {
    const node = element("button", { type: "button", title: model.get("tooltip") }, model.get("description"));
    node.disabled = model.get("disabled");
    return asleep(model, node, element("div", { class: "live-row" }, node));
  }

  const html = (typeset) => (model) => {
    const node = element("div", { class: "live-html" });
    const show = () => {
      node.innerHTML = model.get("value");
      if (typeset) window.MathJax?.startup?.promise.then(() => MathJax.typesetPromise([node]));
    };
    model.on("change:value", show);
    show();
    return node;
  };

  /** Play and stop; other controls follow through a link. */
  function play(model) {
    let timer = 0;
    const node = element("button", { type: "button", class: "live-play" });
    const show = () => {
      node.textContent = timer ? "❚❚" : "▶";
      node.setAttribute("aria-label", timer ? "Pause" : "Play");
    };
    const stop = () => { timer = void clearInterval(timer) ?? 0; show(); };
    const advance = () => {
      const [value, step, low, high] = ["value", "step", "min", "max"].map((name) => model.get(name));
      if (value + step <= high) return put(model, "value", value + step);
      return model.get("repeat") ? put(model, "value", low) : stop();
    };
    node.addEventListener("click", () => {
      if (timer) return stop();
      if (model.get("value") >= model.get("max")) put(model, "value", model.get("min"));
      timer = setInterval(advance, model.get("interval"));
      return show();
    });
    show();
    return element("div", { class: "live-row" }, node);
  }

  Object.assign(controls, {
    VBoxModel: boxes("live-down"), HBoxModel: boxes("live-across"),
    BoxModel: boxes("live-across"), GridBoxModel: boxes("live-grid"),
    FloatSliderModel: slider("value", number), IntSliderModel: slider("value", number),
    FloatLogSliderModel: slider("value", number),
    SelectionSliderModel: slider("index", (model, k) => model.get("_options_labels")[k]),
    DropdownModel: choice, RadioButtonsModel: choice, ToggleButtonsModel: choice, SelectModel: choice,
    CheckboxModel: checkbox, ToggleButtonModel: checkbox, ButtonModel: button,
    TextModel: text, ComboboxModel: text, IntTextModel: text, FloatTextModel: text, BoundedIntTextModel: text,
    HTMLModel: html(false), HTMLMathModel: html(true), LabelModel: html(true), PlayModel: play,
  });
}
