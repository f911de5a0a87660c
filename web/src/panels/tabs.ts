/** Tabs, by mouse and by arrow keys, as the ARIA practices have them. */

/** Makes the buttons of a tab list show their panels. */
export function makeTabs(list: HTMLElement): void {
  const tabs = [...list.querySelectorAll<HTMLButtonElement>("[role=tab]")];
  const show = (shown: HTMLButtonElement): void => {
    for (const tab of tabs) {
      const selected = tab === shown;
      tab.setAttribute("aria-selected", String(selected));
      tab.tabIndex = selected ? 0 : -1;
      panelOf(tab).hidden = !selected;
    }
  };
  for (const [i, tab] of tabs.entries()) {
    tab.addEventListener("click", () => show(tab));
    tab.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1, Home: -i, End: tabs.length - 1 - i }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      const next = tabs[(i + step + tabs.length) % tabs.length]!;
      show(next);
      next.focus();
    });
  }
}

/** Shows the panel of a tab from elsewhere. */
export function openTab(id: string): void {
  document.getElementById(id)?.click();
}

function panelOf(tab: HTMLButtonElement): HTMLElement {
  return document.getElementById(tab.getAttribute("aria-controls")!)!;
}
