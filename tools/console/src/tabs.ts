// SPDX-License-Identifier: Apache-2.0
// The views, one at a time, by mouse and by arrow keys.

export function connectTabs(shown: (id: string) => void): void {
  const tabs = [...document.querySelectorAll<HTMLButtonElement>('[role="tab"]')];
  const choose = (tab: HTMLButtonElement) => {
    for (const one of tabs) {
      const here = one === tab;
      one.setAttribute('aria-selected', String(here));
      one.tabIndex = here ? 0 : -1;
      document.getElementById(one.getAttribute('aria-controls')!)!.hidden = !here;
    }
    shown(tab.getAttribute('aria-controls')!);
  };
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => choose(tab));
    tab.addEventListener('keydown', (event) => {
      const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const visible = tabs.filter((one) => !one.hidden);
      if (way !== undefined) {
        const next = visible[(visible.indexOf(tabs[i]!) + way + visible.length) % visible.length]!;
        next.focus();
        choose(next);
      }
    });
  });
  choose(tabs[0]!);
}
