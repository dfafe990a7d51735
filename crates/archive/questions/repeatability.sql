-- How well two scans of one person at one station within a day agree at C: the standard deviation of one scan.
with pairs as materialized (
    select a.station, a.scan as first, b.scan as second
    from visit a join visit b on b.patient = a.patient and b.station = a.station
        and b.first_seen > a.first_seen and b.first_seen < a.first_seen + interval '1 day')
select p.station, count(*) as legs, sqrt(avg((a.girth_mm - b.girth_mm) ^ 2) / 2) as sd_mm
from pairs p join level a on a.scan = p.first join level b on b.scan = p.second and b.side = a.side
where a.is_current and a.level = 'C' and b.is_current and b.level = 'C'
group by p.station
order by sd_mm desc
