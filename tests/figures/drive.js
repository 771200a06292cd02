// Drives a page as a user does: sets a drop-down list and fires its event.
const state = () => {
  const model = (name) => Bokeh.documents[0].get_model_by_name(name)
  return {
    compliance: Array.from(model("curve bem").data.compliance),
    resistance: Array.from(model("curve bem").data.resistance),
    named: model("legend of resistance").items.map((item) => item.visible),
    chosen: ["D", "gamma", "m", "phase", "case"].map((name) => model(name).value),
    keyed: model("case").visible,
  }
}
const pause = () => new Promise((done) => setTimeout(done, 200))
const choose = async (number, value) => {
  const select = find(document, "select")[number]
  select.value = value; select.dispatchEvent(new Event("change")); await pause()
}
// The first list, of traces, is hidden.
const drive = async () => {
  while (!find(document, "option").length) await pause()
  const steps = [state()]
  await choose(1, "1.5"); steps.push(state())
  await choose(2, "3"); steps.push(state())
  await choose(3, "3"); steps.push(state())
  const result = document.createElement("pre"); result.id = "result"
  result.textContent = JSON.stringify(steps); document.body.append(result)
}
drive()
