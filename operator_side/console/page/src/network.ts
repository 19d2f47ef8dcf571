// The menu of networks and the outage, where an emulator can be told.
import { element, put } from "./dom.ts";
import type { Networks, Said } from "./told.ts";

const OUTAGE_S = 3;

export class NetworkMenu {
  private names = "";

  constructor(say: (said: Said) => void) {
    const menu = element<HTMLSelectElement>("network");
    menu.addEventListener("change", () => {
      say({ kind: "network", name: menu.value });
      menu.blur(); // so that keys drive again
    });
    element("outage").addEventListener("click", () => say({ kind: "outage", seconds: OUTAGE_S }));
  }

  show(told: Networks | null | undefined): void {
    const box = element("net");
    box.hidden = !told;
    if (!told) return;
    const menu = element<HTMLSelectElement>("network");
    const names = told.names.includes(told.name) ? told.names : [told.name, ...told.names];
    const key = names.join("\n");
    if (key !== this.names) {
      this.names = key;
      menu.replaceChildren(...names.map((name) => new Option(name, name)));
    }
    if (document.activeElement !== menu && menu.value !== told.name) menu.value = told.name;
    menu.disabled = !told.changeable;
    const outage = element<HTMLButtonElement>("outage");
    outage.disabled = !told.changeable || told.outage;
    outage.classList.toggle("on", told.outage);
    put("outage", told.outage ? "outage now" : `outage ${OUTAGE_S} s`);
    box.title = told.refused || `up ${told.uplink}, down ${told.downlink}`;
    put("net-refused", told.refused);
  }
}
