{
  const first = document.getElementById("first-only");
  first?.addEventListener("change", () => document.documentElement.classList.toggle("first-only", first.checked));
  document.getElementById("print")?.addEventListener("click", () => window.print());
  // Paper says until when the measures hold; a page knows today, and counts.
  const age = document.getElementById("age");
  if (age) {
    const [year, month, day] = age.dataset.taken.split("-").map(Number);
    const now = new Date();
    const today = Date.UTC(now.getFullYear(), now.getMonth(), now.getDate());
    const days = Math.round((today - Date.UTC(year, month - 1, day)) / 86_400_000);
    const isOld = days > Number(age.dataset.most);
    age.append(` ${(isOld ? age.dataset.old : age.dataset.fresh).replace("{days}", days)}`);
    age.classList.toggle("too-old", isOld);
  }
  const place = document.getElementById("view-place");
  if (place) {
    const record = JSON.parse(document.getElementById("record").textContent);
    const patient = document.querySelector("h1").textContent;
    gaiterViewer.mount(place, record, { patient });
    // The sheet's own drawing shows the same legs and levels; it is for paper and for where there is no view.
    if (place.querySelector("canvas")) document.body.classList.add("viewing");
  }
}
