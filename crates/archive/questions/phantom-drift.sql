-- Stations whose phantom has drifted by more than 1 mm in the last 90 days, by a line through its days.
select station, count(*) as days, 90 * regr_slope(phantom_bias_mm, day - current_date) as drift_mm,
    avg(phantom_bias_mm) as mean_mm
from station_history
where day > current_date - 90 and phantom_bias_mm is not null
group by station
having count(*) >= 10 and abs(90 * regr_slope(phantom_bias_mm, day - current_date)) > 1
order by abs(90 * regr_slope(phantom_bias_mm, day - current_date)) desc
