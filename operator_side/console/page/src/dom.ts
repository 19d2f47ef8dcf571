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

/** The same with what is measured in it made bold. */
export function emphasise(id: string, text: string): void {
  const at = element(id);
  if (at.textContent === text) return;
  const parts = text.split(/((?:[≤≥] )?\b\d+(?:\.\d+)?(?: mm| ms| s)?\b)/);
  at.replaceChildren(
    ...parts.filter(Boolean).map((part) => {
      if (!/^([≤≥] )?\d/.test(part)) return part;
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
