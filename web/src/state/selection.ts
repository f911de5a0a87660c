/** What is selected: it has the handles in the scene and its fields in the panels. */

export type Selected =
  | { kind: "point"; index: number }
  | { kind: "obstacle"; index: number }
  | { kind: "part"; index: number }
  | { kind: "frame" }
  | { kind: "tool" };

export class Selection {
  now: Selected | null = null;
  private readonly listeners: (() => void)[] = [];

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  set(selected: Selected | null): void {
    if (nameOf(selected) === nameOf(this.now)) return;
    this.now = selected;
    for (const listener of this.listeners) listener();
  }

  /** The index where something of a kind is selected, else -1. */
  index(kind: "point" | "obstacle" | "part"): number {
    return this.now !== null && this.now.kind === kind && "index" in this.now ? this.now.index : -1;
  }
}

export function nameOf(selected: Selected | null): string {
  if (selected === null) return "";
  return "index" in selected ? `${selected.kind}-${selected.index}` : selected.kind;
}
