/** Fields of forms: numbers in the unit shown, choices, small buttons; and lists drawn anew. */

import { h } from "../dom";
import { angleUnit, lengthUnit, scaleOf } from "../units";

export type Kind = "length" | "angle" | "plain";

/** A number with its unit; `change` hears of values in the document's unit, null: left empty. */
export function numberField(
  label: string, value: number | null, kind: Kind, change: (value: number | null) => void,
  options: { key: string; min?: number; max?: number; placeholder?: string; short?: string } = { key: label },
): HTMLLabelElement {
  const scale = kind === "plain" ? 1 : scaleOf(kind);
  const unit = kind === "plain" ? "" : kind === "length" ? lengthUnit() : angleUnit();
  const input = h("input", {
    type: "number", step: "any", "data-key": options.key, autocomplete: "off",
    "aria-label": unit === "" ? label : `${label} [${unit}]`,
    ...(options.min === undefined ? {} : { min: options.min * scale }),
    ...(options.max === undefined ? {} : { max: options.max * scale }),
    ...(options.placeholder === undefined ? {} : { placeholder: options.placeholder }),
    value: value === null ? "" : String(Number((value * scale).toFixed(kind === "angle" ? 3 : 6))),
    onchange: () => {
      if (input.value === "") change(null);
      else if (input.checkValidity()) change(Number(input.value) / scale);
    },
  });
  return h("label", { class: "field" }, h("span", {}, options.short ?? label), input);
}

/** Three numbers in a row. */
export function vectorFields(
  name: string, axes: string[], values: number[], kind: Kind, change: (values: number[]) => void,
): HTMLElement {
  return h("div", { class: "vector", role: "group", "aria-label": name }, ...axes.map((axis, i) =>
    numberField(`${name} ${axis}`, values[i]!, kind, (value) => {
      if (value !== null) change(values.map((old, k) => (k === i ? value : old)));
    }, { key: `${name}-${axis}`, short: axis })));
}

export function choice(
  label: string, value: string, options: [string, string][], key: string, change: (value: string) => void,
): HTMLSelectElement {
  const select = h("select", { "aria-label": label, "data-key": key, onchange: () => change(select.value) },
    ...options.map(([name, title]) => h("option", { value: name, selected: name === value }, title)));
  return select;
}

export function button(label: string, key: string, act: () => void, text = label, disabled = false): HTMLButtonElement {
  return h("button", {
    type: "button", class: text === label ? "" : "small", "data-key": key, disabled,
    ...(text === label ? {} : { "aria-label": label, title: label }), onclick: act,
  }, text);
}

/** Draws a part of the page anew; what had the focus has it again, and text under way is kept. */
export function redraw(host: HTMLElement, ...children: (Node | string)[]): void {
  const active = host.contains(document.activeElement) ? document.activeElement as HTMLElement : null;
  const key = active?.dataset["key"];
  const top = host.scrollTop;
  host.replaceChildren(...children);
  host.scrollTop = top;
  if (key === undefined) return;
  const again = host.querySelector<HTMLElement>(`[data-key="${CSS.escape(key)}"]:not(:disabled)`);
  (again ?? host.querySelector<HTMLElement>("[data-key]"))?.focus();
}
