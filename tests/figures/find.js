// Elements of a kind, also in the shadow roots of widgets.
const find = (root, kind) => [...root.querySelectorAll("*")].flatMap(
  (each) => [...(each.matches(kind) ? [each] : []), ...(each.shadowRoot ? find(each.shadowRoot, kind) : [])])
