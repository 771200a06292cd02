// Sends the page that frames it how wide the page has become, and where the parts of it end.
const measure = () => {
  if (find(document, "canvas").length < 2) return setTimeout(measure, 200)
  const parts = find(document, "select, canvas, input, img, details, nav")
  const ends = parts.map((each) => each.getBoundingClientRect().right)
  const { clientWidth, scrollWidth } = document.documentElement
  parent.postMessage({ window: clientWidth, page: scrollWidth, ends }, "*")
}
setTimeout(measure, 1000)
