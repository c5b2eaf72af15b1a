// The rest of the page: theme, cases, tables, copying.
(() => {
  const find = (selector, root = document) => root.querySelector(selector);
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const make = (name, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...children);
    return element;
  };
  let redraw = () => {};

  // Theme: that of the system until the button is pressed.
  const button = find("#theme");
  const system = matchMedia("(prefers-color-scheme: dark)");
  const setTheme = (isDark) => {
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    button.textContent = isDark ? "Light" : "Dark";
    redraw();
  };
  setTheme(system.matches);
  button.hidden = false;
  system.addEventListener("change", () => setTheme(system.matches));
  button.addEventListener("click", () => setTheme(document.documentElement.dataset.theme !== "dark"));

  // A number in short, and a mean to two digits of its error.
  const short = (value) => (value === 0 ? "0" : Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5 ? value.toExponential(2) : String(Number(value.toPrecision(6))));
  const withError = (mean, error) => {
    if (!(error > 1e-12)) return short(mean);
    const digits = Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(error))));
    return `${mean.toFixed(digits).replace(/^-(?=[0.]*$)/, "")} ± ${error.toFixed(digits)}`;
  };

  // Tables: from the text of the CSV file when they are unfolded.
  const parse = (text) => {
    const rows = [[""]];
    let quoted = false;
    for (let i = 0; i < text.length; i++) {
      const letter = text[i];
      const row = rows[rows.length - 1];
      if (quoted) {
        if (letter !== '"') row[row.length - 1] += letter;
        else if (text[i + 1] === '"') { row[row.length - 1] += '"'; i++; } else quoted = false;
      } else if (letter === '"') quoted = true;
      else if (letter === ",") row.push("");
      else if (letter === "\n") { if (i + 1 < text.length) rows.push([""]); } else row[row.length - 1] += letter;
    }
    return rows;
  };
  const tableOf = (name, text) => {
    const [names, ...rows] = parse(text);
    // A column of errors stands with its means.
    const errors = names.map((name) => names.indexOf(`${name}_se`));
    const shown = names.map((_, i) => i).filter((i) => !errors.includes(i));
    const cell = (row, i) => {
      const number = Number(row[i]);
      if (row[i] === "" || Number.isNaN(number)) return row[i];
      return errors[i] >= 0 && row[errors[i]] !== "" ? withError(number, Number(row[errors[i]])) : short(number);
    };
    const head = make("tr", {}, ...shown.map((i) => make("th", { scope: "col", textContent: names[i] })));
    const body = rows.map((row) => make("tr", {}, ...shown.map((i) => make("td", { textContent: cell(row, i), title: row[i] }))));
    const table = make("table", { className: "numbers" }, make("thead", {}, head), make("tbody", {}, ...body));
    return make("div", { className: "scroll", tabIndex: 0, role: "group", ariaLabel: name }, table);
  };
  for (const details of all(".table")) {
    const source = find("pre", details);
    source.hidden = true;
    find(".tools", details).hidden = false;
    details.addEventListener("toggle", () => {
      if (details.open && !find("table", details)) details.append(tableOf(details.dataset.name, source.textContent));
    });
  }

  // Copies a text, also where the page is a local file and has no clipboard.
  const copy = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = make("textarea", { value: text });
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
  };
  for (const button of all("[data-do]")) {
    button.hidden = false;
    button.addEventListener("click", async () => {
      const holder = button.closest(".table, .command");
      const text = find("pre", holder).textContent;
      if (button.dataset.do === "copy") {
        await copy(text);
        button.textContent = "Copied";
        setTimeout(() => { button.textContent = "Copy"; }, 1500);
      } else {
        const link = make("a", { href: URL.createObjectURL(new Blob([text], { type: "text/csv" })), download: holder.dataset.name.replaceAll("/", "_") });
        link.click();
        URL.revokeObjectURL(link.href);
      }
    });
  }

  // Titles of areas of figures, at the pointer and by keyboard.
  const tip = make("div", { className: "tip", hidden: true });
  document.body.append(tip);
  const addTips = (root) => all("svg [tabindex]", root).forEach((area) => {
    const title = find("title", area);
    area.setAttribute("aria-label", title.textContent);
    area.setAttribute("role", "img");
    const text = title.textContent;
    title.remove();
    const showTip = () => {
      const box = area.getBoundingClientRect();
      tip.textContent = text;
      tip.hidden = false;
      tip.style.left = `${Math.min(box.left + box.width / 2, innerWidth - 330) + scrollX}px`;
      tip.style.top = `${box.bottom + scrollY + 4}px`;
    };
    const hideTip = () => { tip.hidden = true; };
    area.addEventListener("pointerenter", showTip);
    area.addEventListener("focus", showTip);
    area.addEventListener("pointerleave", hideTip);
    area.addEventListener("blur", hideTip);
  });
  addTips(document);

  // Figures that are hidden at first, or large, are compressed until they are shown.
  const unpack = async (holder) => {
    const bytes = Uint8Array.from(atob(holder.dataset.packed), (letter) => letter.charCodeAt(0));
    delete holder.dataset.packed;
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    holder.innerHTML = await new Response(stream).text();
    addTips(holder);
  };
  all("figure:not([hidden]) [data-packed]").forEach(unpack);

  addEventListener("beforeprint", () => all(".part").forEach((details) => { details.open = true; }));

  const source = find("#data");
  if (!source) return;
  const data = JSON.parse(source.textContent);
  const section = find("#lobes");
  section.hidden = false;
  const groups = [...new Set(data.cases.map((one) => one.group))];
  const inGroup = (group) => data.cases.map((one, number) => number).filter((number) => data.cases[number].group === group);
  const state = { number: 0, side: "both", isLog: true, isCommon: false, part: "all", wires: new Set() };
  const controls = find("#controls");
  const choice = (text, options, onChange) => {
    const select = make("select", {}, ...options.map(([value, name]) => make("option", { value, textContent: name })));
    select.addEventListener("change", () => onChange(select.value));
    controls.append(make("label", {}, text, select));
    return select;
  };

  // Cases: a list of settings, and a slider over the angles of the light.
  if (groups.length > 1) choice("Setting", groups.map((group, i) => [i, group]), (i) => {
    // The same direction of the other setting, if it has it.
    const { theta } = data.cases[state.number];
    const numbers = inGroup(groups[i]);
    state.number = numbers.find((number) => data.cases[number].theta === theta) ?? numbers[0];
    update();
  }).id = "setting";
  const slider = make("input", { type: "range", min: 0, step: 1, id: "angle" });
  const angle = make("output");
  slider.addEventListener("input", () => { state.number = inGroup(data.cases[state.number].group)[slider.value]; update(); });
  const light = make("label", {}, "Light", slider, angle);
  controls.append(light);

  const wiresOf = (lobes) => {
    const named = new Map();
    for (const side of lobes.sides) for (const model of side.models) named.set(model.name, null);
    const own = data.cases[lobes.case];
    // Of other folders the same direction, and the same setting where there is one.
    const of = (other) => data.cases[other.case];
    const others = data.lobes.filter((other) => of(other).part !== own.part && of(other).theta === own.theta && of(other).phi === own.phi);
    const alike = others.filter((other) => of(other).setting === own.setting);
    for (const other of alike.length ? alike : others) named.set(of(other).label, other);
    return named;
  };
  // Colours of wires of other folders.
  const OTHERS = ["#E69F00", "#56B4E9", "#CC79A7", "#009E73"];
  const lobesOf = (number) => data.lobes.find((lobes) => lobes.case === number);
  const sides = [...new Set(data.lobes.flatMap((lobes) => lobes.sides.map((side) => side.side)))];
  if (sides.length > 1) choice("Side", [["both", "both"], ...sides.map((side) => [side, side])], (side) => { state.side = side; update(); }).id = "side";
  else state.side = sides[0];
  choice("Scale", [["log", "logarithmic, 4 decades"], ["linear", "linear"]], (scale) => { state.isLog = scale === "log"; update(); }).id = "scaling";
  const radii = [["own", "each side and direction by itself"], ["common", "the same for all"]];
  choice("Radius", radii, (radius) => { state.isCommon = radius === "common"; update(); }).id = "radius";
  const parts = [...new Set(data.lobes.flatMap((lobes) => lobes.sides.flatMap((side) => side.rays.map((array) => array.name))))].filter((name) => name !== "se");
  if (parts.length > 1) choice("Rays", parts.map((name) => [name, name.replaceAll("_", " ")]), (part) => { state.part = part; update(); }).id = "part";
  const wireBox = make("span", { className: "controls" });
  controls.append(wireBox);

  const readout = find("#readout");
  const view = lobeView(find("#lobe"), find("#labels"), (point) => {
    if (!point) { readout.textContent = ""; return; }
    const { vertex, side, error } = point;
    const round = (number) => String(Number(number.toFixed(2)));
    readout.textContent = `${side}, θₒ = ${round(vertex.theta)}°, φₒ = ${round(vertex.phi)}°: ${withError(vertex.value, error)} 1/sr`;
  });
  if (!view) {
    find(".stage").hidden = true;
    find("#scale").hidden = true;
    find("#fallback").hidden = false;
  }
  const themed = (name) => lobeColour(getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  redraw = () => { if (view) update(); };

  function update() {
    const own = data.cases[state.number];
    const numbers = inGroup(own.group);
    light.hidden = numbers.length < 2;
    slider.max = numbers.length - 1;
    slider.value = numbers.indexOf(state.number);
    slider.setAttribute("aria-valuetext", own.label);
    angle.textContent = own.angle;
    // Of each folder the case that is chosen, that of the same direction and setting, or its first.
    const chosen = (part) => {
      if (part === own.part) return state.number;
      const ofPart = data.cases.map((one, number) => number).filter((number) => data.cases[number].part === part);
      const isAlike = ({ setting, theta, phi }) => setting === own.setting && theta === own.theta && phi === own.phi;
      return ofPart.find((number) => isAlike(data.cases[number])) ?? ofPart[0];
    };
    for (const figure of all(".figures figure")) {
      const number = chosen(Number(figure.parentElement.dataset.part));
      const { case: ofCase, theta } = figure.dataset;
      const isOther = ofCase !== undefined && Number(ofCase) !== number;
      const isAtOther = theta !== undefined && number !== undefined && Math.abs(theta - data.cases[number].theta) > 1e-4;
      figure.hidden = isOther || isAtOther;
      const packed = find("[data-packed]", figure);
      if (packed && !figure.hidden) unpack(packed);
    }
    for (const row of all("tr[data-row]")) row.classList.toggle("chosen", Number(row.dataset.row) === state.number);
    const lobes = lobesOf(state.number);
    readout.textContent = "";
    find("#absent").hidden = Boolean(lobes);
    if (!view) return;
    if (!lobes) {
      wireBox.replaceChildren();
      find("#scale").replaceChildren();
      view.clear();
      return;
    }
    const array = (side, name) => side.rays.find((one) => one.name === name) || side.rays[0];
    const isShown = (side) => (state.side === "both" || side.side === state.side) && array(side, state.part).max > 0;
    const shown = lobes.sides.filter(isShown);
    const named = wiresOf(lobes);
    const root = getComputedStyle(document.documentElement);
    const colours = new Map([...named].map(([name, other], i) => {
      const model = lobes.sides.flatMap((side) => side.models).find((one) => one.name === name);
      const colour = other || !model ? OTHERS[i % OTHERS.length] : model.colour;
      return [name, root.getPropertyValue(`--c${colour.slice(1)}`).trim() || colour];
    }));
    wireBox.replaceChildren(...[...named.keys()].map((name, i) => {
      const box = make("input", { type: "checkbox", checked: state.wires.has(name) });
      box.addEventListener("change", () => {
        if (box.checked) state.wires.add(name);
        else state.wires.delete(name);
        update();
        all("input", wireBox)[i].focus();
      });
      const swatch = make("span", { className: "swatch" });
      swatch.style.borderColor = colours.get(name);
      return make("label", {}, box, swatch, name);
    }));
    const max = {};
    const drawn = shown.map((side) => {
      const rays = array(side, state.part);
      const all = data.lobes.flatMap((one) => one.sides.map((other) => array(other, state.part).max));
      max[side.side] = state.isCommon ? Math.max(...all) : rays.max;
      const errors = state.part === "all" && side.rays.find((one) => one.name === "se");
      return { side: side.side, rows: lobeRows(side, lobeValues(rays)), max: max[side.side], errors: errors && lobeValues(errors) };
    });
    const wires = [...named.keys()].flatMap((name) => {
      if (!state.wires.has(name)) return [];
      const other = named.get(name);
      return shown.flatMap((side) => {
        const from = other ? other.sides.find((one) => one.side === side.side) : side;
        const values = from && (other ? array(from, state.part) : from.models.find((model) => model.name === name));
        return values ? [{ rows: lobeRows(from, lobeValues(values)), max: max[side.side], colour: lobeColour(colours.get(name)) }] : [];
      });
    });
    view.show({ lobes: drawn, wires, isLog: state.isLog, ink: themed("--faint"), light: { theta: own.theta, phi: own.phi, colour: themed("--ink"), text: `light, ${own.angle}` } });
    find("#scale").replaceChildren(...drawn.map(({ side, max }) => {
      const ramp = make("span", { className: "ramp" });
      ramp.style.background = `linear-gradient(to right, ${LOBE_RAMP.join(",")})`;
      const three = (value) => short(Number(value.toPrecision(3)));
      const low = state.isLog ? three(max * 10 ** -LOBE_DECADES) : "0";
      return make("span", {}, `${side}: ${low}`, ramp, `${three(max)} 1/sr`);
    }));
  }
  update();
})();
