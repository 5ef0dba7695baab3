// Draws the charts of the page by Plotly, from the data in it, as their selectors say. The address keeps the selection.
"use strict";

const DIGITS = 4; // significant ones, of numbers beside a point and in tables
const MOST_TICKS = {named: 12, wide: 6, narrow: 4};
const BUTTONS = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"]};
const [dark, narrow] = ["(prefers-color-scheme: dark)", "(max-width: 40rem)"].map(query => matchMedia(query));
const style = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const told = value => typeof value !== "number" || Number.isInteger(value) ? value : `${+value.toPrecision(DIGITS)}`;
const unfolded = ({values, places}) => places ? places.map(place => values[place]) : values;
const short = text => [...text].reduce((sum, each) => (31 * sum + each.codePointAt(0)) % 2 ** 32, 7).toString(36);

// What the address says, such as #speed.n=65&at=speed: what is chosen, and the place that was looked at last. One
// without = names a section, and leaves what is chosen.
const address = {
  values: new URLSearchParams(),
  read() {
    const said = location.hash.slice(1);
    if (said.includes("=")) address.values = new URLSearchParams(said);
    else if (said && address.values.size) address.say({at: said});
  },
  say(values) {
    Object.entries(values).forEach(each => address.values.set(...each));
    history.replaceState(null, "", `#${address.values}`);
  },
  go() {
    const [first = ""] = address.values.keys();
    document.getElementById(address.values.get("at") ?? first.split(".")[0])?.scrollIntoView();
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
    this.named = row => short(this.line(row) || this.text(row, ",")); // its name when other points are measured too
    this.control = name => this.figure.querySelector(`[name="${name}"]`);
    this.selects = spec.selectors.map(each => this.control(each.column));
    this.selects.forEach(select => select.addEventListener("change", () => { this.draw(); this.say(""); }));
    [this.points, this.command] = ["point", "command"].map(this.control);
    this.points.addEventListener("change", () => this.show(Number(this.points.value), true));
    const copy = () => { this.command.select(); document.execCommand("copy"); }; // in a page of every origin
    this.figure.querySelector("button").addEventListener("click", copy);
    this.details = this.figure.querySelector(".behind");
    this.details.addEventListener("toggle", () => this.tabulate());
    const begin = ([seen]) => seen.isIntersecting && this.begin();
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
    const said = address.values, {name} = this.spec;
    this.selects.forEach(select => {
      const options = [...select.options], wanted = said.get(`${name}.${select.name}`);
      (options.find(each => each.value === wanted) ?? options.find(each => each.defaultSelected)).selected = true;
    });
    this.draw();
    const row = this.rows.find(each => this.named(each) === said.get(`${name}.point`));
    if (row !== undefined) this.show(row, false);
  }

  // Says in the address what is chosen here, and which point.
  say(point) {
    const {name} = this.spec, chosen = this.selects.map(each => [`${name}.${each.name}`, each.value]);
    address.say({...Object.fromEntries(chosen), [`${name}.point`]: point, at: name});
  }

  // Returns the rows that the selectors leave. An option that would leave none, after those before it, is disabled.
  selected() {
    let rows = this.all;
    this.spec.selectors.forEach(({column, at_least, options}, place) => {
      const values = this.columns[column], select = this.selects[place];
      const fits = wanted => row => wanted === null || (at_least ? values[row] >= wanted : values[row] === wanted);
      options.forEach((option, index) => { select.options[index].disabled = !rows.some(fits(option)); });
      const left = [...select.options].filter(each => !each.disabled);
      if (!left.some(each => each.selected)) (left.find(each => each.defaultSelected) ?? left[0]).selected = true;
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
    const known = this.told.filter(({name}) => this.columns[name][row] !== null);
    return known.map(({name, label}) => `${label}: ${told(this.columns[name][row])}`).join(separator);
  }

  trace(rows, name, look) {
    const {x, y} = this.spec, of = column => rows.map(row => this.columns[column]?.[row] ?? null);
    const {fill} = this.columns, symbol = fill ? rows.map(row => look.symbol + fill[row]) : look.symbol;
    const color = dark.matches ? look.dark : look.color;
    return {type: "scatter", mode: look.mode, name, x: of(x.column), y: of(y.column), customdata: rows,
      text: rows.map(row => row === null ? "" : this.text(row, "<br>")), hovertemplate: "%{text}<extra></extra>",
      line: {...look.line, color}, marker: {...look.marker, color, symbol, line: {color, width: 1.4}},
      error_y: {type: "data", symmetric: false, color, thickness: 1, width: 2, visible: "above" in this.columns,
        array: of("above"), arrayminus: of("below")}};
  }

  // Returns the row at each x that any series has, null where these rows have none: there a line is broken.
  atEach(rows) {
    const values = this.columns[this.spec.x.column], all = [...new Set(this.rows.map(row => values[row]))];
    return all.sort((one, other) => one - other).map(value => rows.find(row => values[row] === value) ?? null);
  }

  // Returns a look with its own mark, or where that is taken another, filled alike: so marks differ in grey too.
  apart(look, taken) {
    const fill = look.symbol.match(/-open.*|$/)[0], others = this.spec.marks.map(each => each + fill);
    const symbol = look.joined ? look.symbol : [look.symbol, ...others].find(each => !taken.has(each));
    taken.add(symbol);
    return {...look, symbol: symbol ?? look.symbol};
  }

  traces() {
    const {looks, beaten, x} = this.spec, taken = new Set(), traces = [];
    const shown = new Set(beaten ? this.front(this.rows) : this.rows);
    const series = row => shown.has(row) ? this.columns.series[row] : beaten;
    for (const [name, look] of Object.entries(looks)) {
      const rows = this.rows.filter(row => series(row) === name), all = look.joined && x.has_ticks;
      if (rows.length) traces.push(this.trace(all ? this.atEach(rows) : rows, name, this.apart(look, taken)));
    }
    this.order = [...shown, ...this.rows.filter(row => !shown.has(row))];
    this.figure.querySelector(".count").textContent = `${this.rows.length} points`
      + (beaten ? `, ${shown.size} of them beaten by no other` : "");
    return traces;
  }

  axis({column, layout, has_ticks}) {
    const values = [...new Set(this.rows.map(row => this.columns[column][row]))];
    const named = has_ticks && values.length <= MOST_TICKS.named;
    return {...layout, linecolor: style("grey"), gridcolor: style("line"),
      nticks: MOST_TICKS[narrow.matches ? "narrow" : "wide"],
      ...named && {tickmode: "array", tickvals: values, ticktext: values.map(String)}};
  }

  layout() {
    const shapes = this.spec.shapes.map(each => ({...each, fillcolor: style("shade")}));
    return {xaxis: this.axis(this.spec.x), yaxis: this.axis(this.spec.y), shapes, hovermode: "closest",
      paper_bgcolor: style("ground"), plot_bgcolor: style("ground"), font: {color: style("ink"), size: 13},
      hoverlabel: {align: "left"}, margin: {l: 50, r: 10, t: 32, b: 45}, showlegend: true,
      legend: narrow.matches ? {y: -0.3, yanchor: "top", x: 0} : {}};
  }

  draw() {
    this.rows = this.selected();
    const traces = this.traces();
    this.plot.style.setProperty("--keys", traces.length);
    Plotly.react(this.plot, traces, this.layout(), BUTTONS);
    this.points.replaceChildren(...this.order.map(row => new Option(this.text(row, ", "), row)));
    this.show(this.order.find(row => this.line(row)) ?? this.order[0], false);
    this.tabulate();
  }

  // Shows the command of a point; of one that was chosen the address and the chart tell too.
  show(row, is_chosen) {
    this.points.value = row;
    this.command.value = row === undefined ? "" : this.line(row) || "no program of this project repeats it";
    if (!is_chosen) return;
    this.say(this.named(row));
    const curveNumber = this.plot.data.findIndex(each => each.customdata.includes(row));
    Plotly.Fx.hover(this.plot, [{curveNumber, pointNumber: this.plot.data[curveNumber].customdata.indexOf(row)}]);
  }

  // Fills the table of what is drawn, once it is open.
  tabulate() {
    if (!this.details.open) return;
    const body = this.details.querySelector("tbody"), cells = row => this.told.map(({name}) => this.columns[name][row]);
    body.replaceChildren();
    for (const row of this.order) {
      const line = body.insertRow();
      for (const value of [...cells(row), this.line(row)]) line.insertCell().textContent = told(value) ?? "";
    }
  }
}

address.read();
const charts = JSON.parse(document.getElementById("data").textContent).map(spec => new Chart(spec));
const begun = () => charts.filter(each => each.rows);
const follow = () => { begun().forEach(each => each.restore()); address.go(); };
addEventListener("hashchange", () => { address.read(); if (location.hash.includes("=")) follow(); });
for (const query of [dark, narrow]) query.addEventListener("change", () => begun().forEach(each => each.draw()));
address.go();
