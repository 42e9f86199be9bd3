// Answers recorded when the book was built. A control that calls Python in the notebook finds here
// what Python said then. One control counts at a time: the others of its group go back to start.

{
  const REST = 200; // milliseconds without a move until a dragged point settles on a recorded place
  const GLIDE = 160; // milliseconds of its way there

  class Records {
    constructor(stored) {
      const empty = { start: {}, recordings: [], silent: [], groups: {}, blobs: [] };
      Object.assign(this, empty, stored);
      this.blobs = this.blobs.map((text) => new DataView(Live.bytes(text).buffer));
      this.silent = new Set(this.silent);
      this.byControl = new Map(this.recordings.map((each) => [`${each.control} ${each.trait}`, each]));
      this.input = "pointer";
      addEventListener("keydown", () => { this.input = "key"; }, true);
      addEventListener("pointerdown", () => { this.input = "pointer"; }, true);
    }

    /** Put all that the recording touched where it was before; done once, when the page opens. */
    begin() {
      for (const [id, values] of Object.entries(this.start)) {
        for (const name of Object.keys(values)) values[name] = this.value(values[name]);
        Live.models.get(id)?.assign(values);
      }
      for (const recording of this.recordings) recording.group = this.groups[recording.control];
    }

    isSilent(model) {
      return this.silent.has(model.id);
    }

    stopsOf(id, trait) {
      return this.byControl.get(`${id} ${trait}`)?.stops;
    }

    /** Numbers are stored once, or as those that differ from the start. */
    value(stored, before) {
      if (stored?.blob !== undefined) return this.blobs[stored.blob];
      if (stored?.at === undefined || stored?.is === undefined) return stored;
      const copy = new Float32Array(before.buffer.slice(before.byteOffset, before.byteOffset + before.byteLength));
      const [at, is] = [new Uint32Array(Live.bytes(stored.at).buffer), new Float32Array(Live.bytes(stored.is).buffer)];
      at.forEach((place, k) => { copy[place] = is[k]; });
      return new DataView(copy.buffer);
    }

    /** All of a group's state as it was with the control at stop k: {model: {trait: value}}. */
    stateAt(recording, k) {
      recording.states ??= [];
      recording.states[k] ??= Object.fromEntries(Object.entries(this.start)
        .filter(([id]) => this.groups[id] === recording.group)
        .map(([id, start]) => {
          const answer = recording.answers[k][id] ?? {};
          const names = new Set([...Object.keys(start), ...Object.keys(answer)]);
          return [id, Object.fromEntries([...names].map((name) =>
            [name, name in answer ? this.value(answer[name], start[name]) : start[name]]))];
        }));
      return recording.states[k];
    }

    show(recording, state) {
      for (const [id, values] of Object.entries(state)) {
        const model = Live.models.get(id);
        const own = id === recording.control && recording.trait in values ? [recording.trait] : [];
        const shown = Object.fromEntries(Object.entries(values).filter(([name]) => !own.includes(name)));
        if ("handles" in shown) shown.seen = model.state.lastCount ?? model.get("seen");
        model?.assign(shown);
      }
    }

    /** A widget saved its traits: answer as its kernel did. */
    answer(model, names) {
      if (names.includes("drag")) return this.dragged(model);
      for (const name of names) {
        const recording = this.byControl.get(`${model.id} ${name}`);
        if (recording) this.show(recording, this.stateAt(recording, nearest(recording.stops, model.get(name))));
      }
      return undefined;
    }

    dragged(model) {
      const moves = Object.entries(model.get("drag").moves ?? {});
      if (!moves.length) return;
      const [name, [x, y, count]] = moves.reduce((a, b) => (b[1][2] > a[1][2] ? b : a));
      model.state.lastCount = count;
      const recording = this.byControl.get(`${model.id} ${name}`);
      clearTimeout(this.resting);
      cancelAnimationFrame(this.gliding);
      if (!recording) {
        model.assign({ seen: count, handles: placed(model.get("handles"), name, [x, y]) });
        return;
      }
      this.show(recording, blended(this, recording, [x, y]));
      this.resting = setTimeout(() => this.settle(recording, [x, y]), REST);
    }

    /** Let a dragged point glide to the nearest place where the answer is Python's own. */
    settle(recording, [x, y]) {
      let k = nearestPlace(recording.stops, [x, y]);
      if (this.input === "key" && k === recording.restsAt) k = neighbour(recording, k, [x, y]);
      recording.restsAt = k;
      const [toX, toY] = recording.stops[k];
      const begin = performance.now();
      const step = (now) => {
        const share = Math.min(1, Math.max(0, (now - begin) / GLIDE));
        if (share === 1) return this.show(recording, this.stateAt(recording, k));
        this.show(recording, blended(this, recording, [x + share * (toX - x), y + share * (toY - y)]));
        this.gliding = requestAnimationFrame(step);
        return undefined;
      };
      this.gliding = requestAnimationFrame(step);
    }
  }

  function nearest(stops, value) {
    const distance = (k) => (typeof value === "boolean" ? Number(stops[k] !== value) : Math.abs(stops[k] - value));
    return stops.reduce((best, _, k) => (distance(k) < distance(best) ? k : best), 0);
  }

  function nearestPlace(stops, [x, y]) {
    const distance = ([u, v]) => Math.hypot(u - x, v - y);
    return stops.reduce((best, stop, k) => (distance(stop) < distance(stops[best]) ? k : best), 0);
  }

  /** The recorded place next to k on the side of a point: an arrow key goes one place on. */
  function neighbour(recording, k, [x, y]) {
    const [fromX, fromY] = recording.stops[k];
    const ahead = recording.stops
      .map(([u, v], index) => ({ index, along: (u - fromX) * (x - fromX) + (v - fromY) * (y - fromY), far: Math.hypot(u - fromX, v - fromY) }))
      .filter(({ along, far }) => far > 0 && along / far > 0.9 * Math.hypot(x - fromX, y - fromY));
    return ahead.length ? ahead.reduce((a, b) => (b.far < a.far ? b : a)).index : k;
  }

  function placed(handles, name, at) {
    return handles.map((handle) => (handle.name === name ? { ...handle, at, led: true } : handle));
  }

  /** Between which two places of an axis a number lies, and how far along. */
  function between(places, value) {
    if (places.length === 1) return [0, 0, 0];
    let k = 0;
    while (k < places.length - 2 && places[k + 1] < value) k += 1;
    return [k, k + 1, Math.min(1, Math.max(0, (value - places[k]) / (places[k + 1] - places[k])))];
  }

  /** The state between recorded places: numbers of pictures are blended, the rest is the nearest's. */
  function blended(records, recording, [x, y]) {
    const [xs, ys] = recording.axes;
    const [[i, j, u], [k, l, v]] = [between(xs, x), between(ys, y)];
    const full = recording.stops.length === xs.length * ys.length;
    const state = { ...records.stateAt(recording, nearestPlace(recording.stops, [x, y])) };
    if (!full) return state;
    const corners = [[i, k, (1 - u) * (1 - v)], [j, k, u * (1 - v)], [i, l, (1 - u) * v], [j, l, u * v]]
      .map(([column, line, share]) => [records.stateAt(recording, line * xs.length + column), share]);
    for (const [id, values] of Object.entries(state)) {
      if (!values.handles && !values.layers && !values.data) continue;
      const each = corners.map(([corner, share]) => [corner[id], share]);
      const alike = (name) => new Set(each.map(([corner]) => JSON.stringify(corner[name]))).size === 1;
      const sizes = new Set(each.map(([corner]) => corner.data?.byteLength));
      const mixed = { ...values };
      if (values.data && sizes.size === 1 && alike("layers")) mixed.data = mixNumbers(each.map(([corner, share]) => [corner.data, share]));
      if (values.handles) mixed.handles = mixHandles(each);
      state[id] = mixed;
    }
    return state;
  }

  function mixNumbers(parts) {
    const arrays = parts.map(([view, share]) => [new Float32Array(view.buffer, view.byteOffset, view.byteLength / 4), share]);
    const total = new Float32Array(arrays[0][0].length);
    for (const [array, share] of arrays) {
      if (share) array.forEach((value, k) => { total[k] += share * value; });
    }
    return new DataView(total.buffer);
  }

  function mixHandles(corners) {
    return corners[0][0].handles.map((handle, k) => {
      const at = [0, 1].map((axis) => corners.reduce((sum, [state, share]) => sum + share * state.handles[k].at[axis], 0));
      return { ...handle, at, led: true };
    });
  }

  Live.Records = Records;
}
