/** The text of the document: CodeMirror with the schema's completion and faults in place. */

import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap } from "@codemirror/commands";
import { json, jsonParseLinter } from "@codemirror/lang-json";
import {
  HighlightStyle, bracketMatching, foldGutter, foldKeymap, indentOnInput, syntaxHighlighting,
} from "@codemirror/language";
import { forceLinting, lintGutter, linter, type Diagnostic } from "@codemirror/lint";
import { EditorState } from "@codemirror/state";
import {
  EditorView, drawSelection, highlightActiveLine, keymap, lineNumbers,
} from "@codemirror/view";
import { tags } from "@lezer/highlight";

import type { Problem } from "../documents";
import { fetchOpenapi } from "../service";
import type { DocumentStore } from "../state/store";
import { completer } from "./complete";
import { pathOfField, rangeOf } from "./places";
import { RequestSchema } from "./schema";
import { faultsOf } from "./validate";

const COLOURS = HighlightStyle.define([
  { tag: tags.propertyName, color: "var(--accent)" },
  { tag: tags.string, color: "var(--good)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--text)" },
]);

const LOOK = EditorView.theme({
  "&": { height: "100%", fontSize: "12px", color: "var(--text)", backgroundColor: "var(--field)" },
  "&.cm-focused": { outline: "2px solid var(--accent)", outlineOffset: "-2px" },
  ".cm-scroller": { fontFamily: "var(--mono)", overflow: "auto" },
  ".cm-content": { caretColor: "var(--text)" },
  ".cm-cursor": { borderLeftColor: "var(--text)" },
  ".cm-gutters": { backgroundColor: "var(--field)", color: "var(--soft)", borderRight: "1px solid var(--line)" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "var(--wash)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground":
    { background: "var(--selected)" },
  ".cm-tooltip": { backgroundColor: "var(--card)", color: "var(--text)", border: "1px solid var(--line)" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { background: "var(--accent)", color: "var(--on-accent)" },
  ".cm-completionInfo": { maxWidth: "320px" },
  ".cm-foldPlaceholder": { background: "var(--wash)", border: "0", color: "var(--soft)" },
});

export class JsonEditor {
  private readonly view: EditorView;
  private schema: RequestSchema | null = null;
  private refused: { text: string; problem: Problem } | null = null;
  private taking = false;

  constructor(host: HTMLElement, private readonly store: DocumentStore, submit: () => void, robots: () => string[]) {
    // In a tree of its own its styles need no inline style, which the page's policy forbids.
    const root = host.attachShadow({ mode: "open" });
    let document: unknown = {};
    store.onChange((origin) => {
      if (store.request !== null) document = store.request;
      if (origin === "page") this.take(store.text);
    });
    this.view = new EditorView({
      root, parent: root,
      state: EditorState.create({
        doc: store.text,
        extensions: [
          keymap.of([
            { key: "Mod-Enter", run: () => (submit(), true) },
            { key: "Mod-z", run: () => (store.undo(), true) },
            { key: "Mod-y", mac: "Mod-Shift-z", run: () => (store.redo(), true) },
            { key: "Mod-Shift-z", run: () => (store.redo(), true) },
            // Tab leaves the editor, as everywhere on the page, unless a completion is open.
            ...closeBracketsKeymap, ...completionKeymap, ...foldKeymap, ...defaultKeymap,
          ]),
          lineNumbers(), foldGutter(), drawSelection(), indentOnInput(), bracketMatching(), closeBrackets(),
          highlightActiveLine(), json(), syntaxHighlighting(COLOURS), LOOK, lintGutter(),
          autocompletion({ override: [completer(() => this.schema, () => document, robots)] }),
          linter((view) => this.lint(view), { delay: 250 }),
          EditorView.contentAttributes.of({ tabindex: "0", "aria-label": "Document (JSON, metres and radians)" }),
          EditorView.updateListener.of((update) => {
            if (update.docChanged && !this.taking) store.write(update.state.doc.toString(), "editor", "typing");
          }),
        ],
      }),
    });
  }

  /** Fetches the schema; without it the editor still reads JSON. */
  async learn(): Promise<void> {
    this.schema = new RequestSchema(await fetchOpenapi());
    forceLinting(this.view);
  }

  /** Marks the fields that the service has refused, until the text changes. */
  mark(problem: Problem | null): void {
    this.refused = problem === null ? null : { text: this.store.text, problem };
    forceLinting(this.view);
  }

  private take(text: string): void {
    const old = this.view.state.doc.toString();
    if (text === old) return;
    // Only what differs is replaced, so that the cursor and the folds stay.
    let first = 0;
    while (first < Math.min(old.length, text.length) && old[first] === text[first]) first += 1;
    let last = 0;
    while (last < Math.min(old.length, text.length) - first && old.at(-1 - last) === text.at(-1 - last)) last += 1;
    this.taking = true;
    this.view.dispatch({ changes: { from: first, to: old.length - last, insert: text.slice(first, text.length - last) } });
    this.taking = false;
  }

  private lint(view: EditorView): Diagnostic[] {
    const { state } = view;
    if (this.store.request === null) return jsonParseLinter()(view);
    const faults = this.schema === null ? [] : faultsOf(this.schema, this.store.request);
    const found = faults.map(({ path, text }): Diagnostic =>
      ({ ...rangeOf(state, path), severity: "error", message: text }));
    if (this.refused !== null && this.refused.text === this.store.text) {
      const { field, detail, errors } = this.refused.problem;
      const told = errors ?? (field === undefined ? [] : [{ field, detail }]);
      for (const { field: at, detail: why } of told) {
        found.push({ ...rangeOf(state, pathOfField(at)), severity: "error", message: why });
      }
    }
    return found;
  }
}
