// Drives a page as a user does: sets the list of cases and fires its event.
const find = (root, kind) => [...root.querySelectorAll("*")].flatMap(
  (each) => [...(each.matches(kind) ? [each] : []), ...(each.shadowRoot ? find(each.shadowRoot, kind) : [])])
const state = () => {
  const { data } = Bokeh.documents[0].get_model_by_name("curve bem")
  return { compliance: Array.from(data.compliance), resistance: Array.from(data.resistance) }
}
const pause = () => new Promise((done) => setTimeout(done, 200))
const drive = async () => {
  while (!find(document, "option").length) await pause()
  const steps = [state()], [select] = find(document, "select")
  select.value = select.options[2].value; select.dispatchEvent(new Event("change")); await pause()
  steps.push(state())
  const result = document.createElement("pre"); result.id = "result"
  result.textContent = JSON.stringify(steps); document.body.append(result)
}
drive()
