// The widgets of a page without a kernel: their stored state as models, and links between them.
// Classic scripts, not modules: a browser loads no module from a file on disk.

const Live = { models: new Map(), controls: {}, modules: window.liveModules ?? {} };

/** Make an element; attributes named on… are listeners, null leaves an attribute out. */
Live.element = (tag, attributes = {}, ...children) => {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
};

Live.bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

/** The state of one widget. It has the methods that anywidget promises to a front end. */
Live.Model = class {
  constructor(id, { model_name: name, state, buffers = [] }) {
    Object.assign(this, { id, name, state, listeners: new Map(), unsaved: new Set() });
    for (const { path, data } of buffers) {
      const at = path.slice(0, -1).reduce((place, step) => place[step], state);
      at[path.at(-1)] = new DataView(Live.bytes(data).buffer);
    }
    this.widget_manager = { get_model: async (other) => Live.models.get(other) };
  }

  get(name) {
    return this.state[name];
  }

  set(name, value) {
    const values = typeof name === "string" ? { [name]: value } : name;
    for (const each of this.assign(values)) this.unsaved.add(each);
  }

  /** What a widget does to tell its kernel: here the records listen instead. */
  save_changes() {
    const names = [...this.unsaved];
    this.unsaved.clear();
    if (names.length) Live.records.answer(this, names);
  }

  /** Take values without telling the records; returns the names of those that are new. */
  assign(values) {
    const names = Object.keys(values).filter((name) => this.state[name] !== values[name]);
    Object.assign(this.state, values);
    for (const name of names) this.tell(`change:${name}`, this.state[name]);
    if (names.length) this.tell("change");
    return names;
  }

  tell(event, value) {
    for (const listener of [...(this.listeners.get(event) ?? [])]) listener(this, value);
  }

  on(events, listener) {
    for (const event of events.split(" ")) {
      this.listeners.set(event, [...(this.listeners.get(event) ?? []), listener]);
    }
  }

  off(events, listener) {
    for (const event of (events ?? [...this.listeners.keys()].join(" ")).split(" ")) {
      const kept = (this.listeners.get(event) ?? []).filter((other) => listener && other !== listener);
      this.listeners.set(event, kept);
    }
  }

  /** The model that a trait such as layout or a child refers to. */
  linked(reference) {
    return Live.models.get(String(reference).replace("IPY_MODEL_", ""));
  }

  send() {} // messages of a widget's own: nobody hears them
};

/** Two traits that follow each other in the page, ipywidgets' jslink and jsdlink. */
Live.link = (model) => {
  const [[from, name], [to, other]] = ["source", "target"].map((end) => {
    const [reference, trait] = model.get(end);
    return [model.linked(reference), trait];
  });
  const follow = (leader, trait, follower, its) => leader.on(`change:${trait}`, () => {
    if (follower.get(its) === leader.get(trait)) return;
    follower.set(its, leader.get(trait));
    follower.save_changes();
  });
  follow(from, name, to, other);
  if (model.name === "LinkModel") follow(to, other, from, name);
};

/** Read the page's stored state. */
Live.readModels = (stored) => {
  for (const [id, record] of Object.entries(stored.state)) Live.models.set(id, new Live.Model(id, record));
};
