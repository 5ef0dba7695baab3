// Draws the charts of the page by Plotly, from the data in it, as their selectors say. The address keeps the selection.
"use strict";

const TOLD_DIGITS = 4; // significant ones, of numbers beside a point and in tables
const MAX_NAMED_TICKS = 12;
const FEW_TICKS = {wide: 8, narrow: 4}; // decades that each have a tick; of more, some
const HEIGHT = {wide: 30, chart: 19, key: 1.25}; // of a plot, in rem; in a narrow window the key stands below the chart
const dark = matchMedia("(prefers-color-scheme: dark)");
const narrow = matchMedia("(max-width: 40rem)");
const style = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const told = value => typeof value !== "number" || Number.isInteger(value) ? value
  : String(Number(value.toPrecision(TOLD_DIGITS)));
const unfolded = ({values, places}) => places ? places.map(place => values[place]) : values;

// What the address says, such as #speed.n=65&speed.scene=rough, T = 5. One without = names a section.
const address = {
  read: () => { address.values = new URLSearchParams(location.hash.includes("=") ? location.hash.slice(1) : ""); },
  say(key, value) {
    address.values.set(key, value);
    history.replaceState(null, "", `#${address.values}`);
  },
};

class Chart {
  constructor(spec) {
    this.spec = spec;
    this.figure = document.getElementById(spec.name);
    this.plot = this.figure.querySelector(".plot");
    this.columns = Object.fromEntries(spec.columns.map(each => [each.name, unfolded(each)]));
    this.told = spec.columns.filter(each => each.label);
    this.all = spec.commands.map((_, row) => row);
    this.line = row => spec.commands[row].map(part => spec.parts[part]).join(" --");
    this.control = name => this.figure.querySelector(`[name="${name}"]`);
    this.selects = spec.selectors.map(each => this.control(each.column));
    this.selects.forEach(select => select.addEventListener("change", () => {
      address.say(`${spec.name}.${select.name}`, select.value);
      this.draw();
    }));
    [this.points, this.command] = ["point", "command"].map(this.control);
    this.points.addEventListener("change", () => this.show(Number(this.points.value), true));
    this.figure.querySelector("button").addEventListener("click", () => this.copy());
    this.details = this.figure.querySelector(".behind");
    this.details.addEventListener("toggle", () => this.tabulate());
    const begin = ([seen]) => { if (seen.isIntersecting) this.begin(); };
    new IntersectionObserver(begin, {rootMargin: "300px"}).observe(this.figure);
  }

  // Draws it for the first time, when it comes near to what is seen: so the page is there soon.
  begin() {
    if (this.rows) return;
    this.restore();
    this.plot.on("plotly_click", event => this.show(event.points[0].customdata, true));
  }

  // Takes what the address says of this chart; what it does not say is as at first.
  restore() {
    const said = address.values;
    this.selects.forEach(select => {
      const options = [...select.options], wanted = said.get(`${this.spec.name}.${select.name}`);
      (options.find(each => each.value === wanted) ?? options.find(each => each.defaultSelected)).selected = true;
    });
    this.draw();
    const point = Number(said.get(`${this.spec.name}.point`) ?? NaN);
    if (this.rows.includes(point)) this.show(point, false);
  }

  // Returns the rows that the selectors leave. An option that would leave none, after those before it, is disabled.
  selected() {
    let rows = this.all;
    this.spec.selectors.forEach(({column, at_least, options}, place) => {
      const values = this.columns[column], select = this.selects[place];
      const fits = wanted => row => wanted === null || (at_least ? values[row] >= wanted : values[row] === wanted);
      options.forEach((option, index) => { select.options[index].disabled = !rows.some(fits(option)); });
      if (select.options[select.selectedIndex].disabled)
        select.selectedIndex = [...select.options].findIndex(each => !each.disabled);
      rows = rows.filter(fits(options[select.selectedIndex]));
    });
    return rows;
  }

  // Returns the rows that no other beats in both coordinates.
  front(rows) {
    const [x, y] = [this.columns[this.spec.x.column], this.columns[this.spec.y.column]];
    let least = Infinity;
    const sorted = [...rows].sort((one, other) => x[one] - x[other] || y[one] - y[other]);
    return sorted.filter(row => y[row] < least && ((least = y[row]), true));
  }

  text(row, separator) {
    const cells = this.told.map(({name, label}) => [label, this.columns[name][row]]);
    const known = cells.filter(([, value]) => value !== null);
    return known.map(([label, value]) => `${label}: ${told(value)}`).join(separator);
  }

  trace(rows, name, look) {
    const {x, y, bars} = this.spec, of = column => rows.map(row => this.columns[column][row] ?? null);
    const colour = dark.matches ? look.dark : look.color, heights = of(y.column);
    const mode = look.joined ? (look.size ? "lines+markers" : "lines") : "markers";
    const trace = {type: "scatter", mode, name, x: of(x.column), y: heights, customdata: rows,
      text: rows.map(row => row === null ? "" : this.text(row, "<br>")), hovertemplate: "%{text}<extra></extra>",
      line: {color: colour, dash: look.dash, width: look.width},
      marker: {color: colour, symbol: look.symbol, size: look.size || 6, line: {color: colour, width: 1.4}}};
    if (bars.length) {
      const [low, high] = bars.map(of);
      trace.error_y = {type: "data", symmetric: false, color: colour, thickness: 1, width: 2,
        array: heights.map((value, place) => (high[place] ?? value) - value),
        arrayminus: heights.map((value, place) => value - (low[place] ?? value))};
    }
    return trace;
  }

  // Returns the row at each x that any series has, null where these rows have none: there a line is broken.
  atEach(rows) {
    const values = this.columns[this.spec.x.column], all = [...new Set(this.rows.map(row => values[row]))];
    return all.sort((one, other) => one - other).map(value => rows.find(row => values[row] === value) ?? null);
  }

  traces() {
    const {looks, has_front, x} = this.spec, names = this.columns.series;
    const shown = has_front ? this.front(this.rows) : this.rows, inFront = new Set(shown), traces = [];
    if (has_front) {
      const grey = {color: style("grey"), dark: style("grey"), symbol: "circle-open", size: 5};
      traces.push(this.trace(this.rows.filter(row => !inFront.has(row)), "beaten by another", grey));
    }
    for (const [name, look] of Object.entries(looks)) {
      const rows = shown.filter(row => names[row] === name);
      if (rows.length) traces.push(this.trace(look.joined && x.has_ticks ? this.atEach(rows) : rows, name, look));
    }
    this.order = [...inFront, ...this.rows.filter(row => !inFront.has(row))];
    this.figure.querySelector(".count").textContent = `${this.rows.length} points`
      + (has_front ? `, ${shown.length} of them beaten by no other` : "");
    return traces;
  }

  axis({column, title, is_logarithmic, is_reversed, has_ticks}) {
    const values = [...new Set(this.rows.map(row => this.columns[column][row]))];
    const decades = Math.log10(Math.max(...values) / Math.min(...values));
    const axis = {title: {text: title}, type: is_logarithmic ? "log" : "linear", zeroline: false, automargin: true,
      linecolor: style("grey"), gridcolor: style("line"), autorange: is_reversed ? "reversed" : true,
      exponentformat: "power"};
    if (has_ticks && values.length <= MAX_NAMED_TICKS)
      return {...axis, tickmode: "array", tickvals: values, ticktext: values.map(String)};
    const step = Math.ceil(decades / FEW_TICKS[narrow.matches ? "narrow" : "wide"]);
    return is_logarithmic ? {...axis, tickangle: 0, dtick: decades < 1 ? "D1" : decades < 2 ? "D2" : step} : axis;
  }

  layout() {
    const {x, y, band} = this.spec, [low, high] = band ?? [];
    const shapes = band ? [{type: "rect", xref: "paper", x0: 0, x1: 1, y1: high, layer: "below", line: {width: 0},
      y0: low ?? Math.min(...this.rows.map(row => this.columns[y.column][row])), fillcolor: style("shade")}] : [];
    return {xaxis: this.axis(x), yaxis: this.axis(y), shapes, hovermode: "closest", showlegend: true, dragmode: "zoom",
      paper_bgcolor: style("ground"), plot_bgcolor: style("ground"), font: {color: style("ink"), size: 13},
      hoverlabel: {align: "left"}, margin: {l: 50, r: 10, t: 32, b: 45},
      legend: narrow.matches ? {y: -0.3, yanchor: "top", x: 0} : {}};
  }

  draw() {
    this.rows = this.selected();
    const traces = this.traces();
    this.plot.style.height = `${narrow.matches ? HEIGHT.chart + HEIGHT.key * traces.length : HEIGHT.wide}rem`;
    Plotly.react(this.plot, traces, this.layout(), {responsive: true, displaylogo: false,
      modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"]});
    this.points.replaceChildren(...this.order.map(row => new Option(this.text(row, ", "), row)));
    this.show(this.order.find(row => this.line(row)) ?? this.order[0], false);
    this.tabulate();
  }

  // Shows the command of a point; one that was chosen goes to the address.
  show(row, is_chosen) {
    if (is_chosen) address.say(`${this.spec.name}.point`, row);
    this.points.value = row;
    this.command.value = row === undefined ? "" : this.line(row) || "no program of this project repeats it";
  }

  copy() {
    this.command.select();
    (navigator.clipboard?.writeText(this.command.value) ?? Promise.reject()).catch(() => document.execCommand("copy"));
  }

  // Fills the table of what is drawn, once it is open.
  tabulate() {
    if (!this.details.open) return;
    const row = (cells, kind) => {
      const line = document.createElement("tr");
      line.append(...cells.map(text => Object.assign(document.createElement(kind), {textContent: text ?? ""})));
      return line;
    };
    this.details.querySelector("table").replaceChildren(row([...this.told.map(each => each.label), "command"], "th"),
      ...this.order.map(each => row([...this.told.map(({name}) => told(this.columns[name][each])),
        this.line(each)], "td")));
  }
}

address.read();
const charts = JSON.parse(document.getElementById("data").textContent).map(spec => new Chart(spec));
const begun = () => charts.filter(each => each.rows);
const follow = () => { address.read(); begun().forEach(each => each.restore()); };
addEventListener("hashchange", () => location.hash.includes("=") && follow());
for (const query of [dark, narrow]) query.addEventListener("change", () => begun().forEach(each => each.draw()));
