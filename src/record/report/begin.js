{
  const first = document.getElementById("first-only");
  first.addEventListener("change", () => document.documentElement.classList.toggle("first-only", first.checked));
  document.getElementById("print").addEventListener("click", () => window.print());
  const record = JSON.parse(document.getElementById("record").textContent);
  const place = document.getElementById("view-place");
  const patient = document.querySelector("h1").textContent;
  gaiterViewer.mount(place, record, { patient });
  // The sheet's own drawing shows the same legs and levels; it is for paper and for where there is no view.
  if (place.querySelector("canvas")) document.body.classList.add("viewing");
}
