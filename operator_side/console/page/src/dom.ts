// The page's elements by their names.

export function element<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found as T;
}

/** Write a text where it is another one. */
export function put(id: string, text: string): void {
  const at = element(id);
  if (at.textContent !== text) at.textContent = text;
}

/** Numbers with a unit, and those that a sentence says without one. */
const MEASURED = /((?:[≤≥] )?\b\d+(?:\.\d+)? (?:mm|ms|s|m\/s)(?![\w/])|(?<=(?:limit|margin|network) )\d+)/;

/** The same with what is measured in it made bold. */
export function emphasise(id: string, text: string): void {
  const at = element(id);
  if (at.textContent === text) return;
  const parts = text.split(MEASURED);
  at.replaceChildren(
    ...parts.map((part, k) => {
      if (k % 2 === 0) return part;
      const bold = document.createElement("b");
      bold.textContent = part;
      return bold;
    }),
  );
}

/** A button's two lines. */
export function label(id: string, bold: string, small: string): void {
  const [b, s] = element(id).children;
  if (b && b.textContent !== bold) b.textContent = bold;
  if (s && s.textContent !== small) s.textContent = small;
}

/** The chosen one of a group of radio buttons. */
export function chosen(name: string): string {
  return document.querySelector<HTMLInputElement>(`input[name="${name}"]:checked`)?.value ?? "";
}
